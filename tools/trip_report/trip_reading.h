#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "controller/realtime/timing_record.h"
#include "controller/runlog/run_list.h"
#include "controller/runlog/run_reader.h"
#include "controller/types/rig_config.h"
#include "tools/trip_report/signal_panels.h"
#include "tools/trip_report/signal_rows.h"

namespace flexarm {

inline constexpr double kWindowBefore_s = 10.0;  ///< shown in full before a trip
inline constexpr double kWindowAfter_s = 3.0;    ///< and after it: the arm comes to rest

/// What the page of a trip is made of: of a log, what stands around the trip, in a size that does
/// not depend on the duration of the run.
struct TripReading {
  static constexpr std::size_t kMostEvents = 300;  ///< the last ones; left_out_events counts others
  static constexpr std::size_t kMostRows = 2000;   ///< of the window

  std::filesystem::path log;
  RunHead head;
  RigConfig config;
  bool digest_holds = false;  ///< false: damaged since it was written, or no closed run
  std::size_t number = 0;     ///< of the trip in the log, from 0
  SafetyRecord trip{};
  std::vector<SafetyRecord> safety;  ///< from the window's begin to the next trip, in order
  std::vector<RunEvent> event;       ///< until the next trip
  std::size_t left_out_events = 0;
  std::vector<TimingRecord> timing;  ///< of the control task, in the window
  std::vector<SignalPanel> panel;
  SignalRows window;   ///< signals of all panels, one after the other; s after the trip
  SignalRows earlier;  ///< before the window, in few rows
  std::int64_t ticks = 0;

  /// An instant of the loop's clock, s after the trip.
  double After_s(std::int64_t time_ns) const {
    return static_cast<double>(time_ns - trip.due_ns) * 1e-9;
  }
};

/// @param number  of the trip in the log, from 0
/// @throws InputError if the log cannot be read or has no such trip; ConfigError
TripReading ReadTrip(const std::filesystem::path& log, std::size_t number);

}  // namespace flexarm
