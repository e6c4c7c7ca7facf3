#pragma once

#include <filesystem>
#include <string>

#include "config/config.h"
#include "tests/controller/runlog/runlog_fixture.h"

namespace flexarm {

inline constexpr std::int64_t kTripTick = 600;  // 12 s after the begin: 2 s are before the window

/// The shipped simulated rig.
inline RigConfig HilRig(const std::vector<std::string>& overrides = {}) {
  return LoadConfig(std::filesystem::path(FLEXARM_SOURCE_DIR) / "config/hil.toml", overrides);
}

inline RunInfo InfoOfTrip() {
  RunInfo info = MakeInfo();
  info.config_text = HilRig().text;
  info.experiment_name = "square";
  info.experiment_text = "";
  return info;
}

/// What is special about a log.
struct TrippedLog {
  RunInfo info = InfoOfTrip();
  Evidence evidence{};
  std::vector<RunEvent> event{};
  TripCauses later = 0;  ///< present half a second after the trip
};

/// A log of 14 s whose arm trips from Running in the safety tick of kTripTick.
inline void WriteTrippedLog(const std::filesystem::path& file, TripCause cause,
                            const TrippedLog& log = {}) {
  RunWriter writer(file, log.info);
  const std::int64_t trip_ns = kTripTick * kTestPeriodNs;
  for (const RunEvent& event : log.event) writer.Event(event);
  SafetyRecord trip = MakeSafety(trip_ns, {SafetyState::kRunning, TripCause::kNone},
                                 RequestKind::kNone, CauseBit(cause));
  trip.evidence = log.evidence;
  writer.Safety(trip);
  if (log.later != 0) {
    writer.Safety(MakeSafety(trip_ns + 500'000'000, trip.after, RequestKind::kNone,
                             CauseBit(cause) | log.later));
  }
  for (std::int64_t tick = 0; tick < kTripTick + 100; ++tick) {
    writer.Tick(MakeTick(tick, tick < kTripTick ? SafetyState::kRunning : SafetyState::kTripped));
  }
  writer.Close("{\"completed\":false,\"trip\":\"" + std::string(ToString(cause)) + "\"}");
}

}  // namespace flexarm
