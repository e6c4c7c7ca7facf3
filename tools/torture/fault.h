#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace flexarm {

inline constexpr std::int64_t kMs = 1'000'000;  ///< a millisecond, ns

/// What a fault spoils. Several have an index: fault.cpp says how many.
enum class FaultPlace : std::uint8_t {
  kGauge,        ///< one strain channel
  kGauges,       ///< all strain channels of one link
  kCounter,      ///< one encoder counter
  kFrame,        ///< every reading of the frame
  kTorque,       ///< the torque of one joint, on its way to the drive
  kLine,         ///< one digital input
  kLineReads,    ///< the call that reads the digital inputs
  kLineWrites,   ///< the call that sets relay and charge pump
  kRelay,        ///< the relay of the power path
  kPump,         ///< the charge pump
  kBusReport,    ///< what the drives' bus reports of itself
  kDriveReport,  ///< what it reports of the drives
  kSafety,       ///< the safety thread
  kControl,      ///< the control thread
  kPlant,        ///< the thread of bus and drives
  kOperator,     ///< the operator thread
  kPlanner,      ///< the planner thread, of a law that plans ahead
};
inline constexpr int kFaultPlaces = 17;

/// How it is spoilt.
enum class FaultKind : std::uint8_t {
  kOff,           ///< nothing comes, or it says that it failed; a thread hangs
  kStuck,         ///< repeats the value of the fault's first instant; a thread pauses for 200 ms
  kGarbage,       ///< any value of the range
  kNotANumber,    ///< no number
  kWrongScale,    ///< twice, half, or the negative of the value
  kSlow,          ///< follows with a lag of 0.2 s; a call of 20 ms; a thread up to 2 periods late
  kDelayed,       ///< the value of three periods before, as if it were new
  kIntermittent,  ///< every other one is missing, at random
  kDrifting,      ///< moves away steadily
  kLate,          ///< the value of one period before, as such; a thread one period late
};
inline constexpr int kFaultKinds = 10;

/// One fault of a session.
struct Fault {
  FaultPlace place;
  int index;  ///< 0-based, of the place
  FaultKind kind;
  std::int64_t from_ns;  ///< in the clock of the loop
  std::int64_t to_ns;    ///< from here on it is well again
  std::uint64_t seed;    ///< of its random values
};

/// Whether it is there at an instant.
constexpr bool IsActive(const Fault& fault, std::int64_t now_ns) noexcept {
  return now_ns >= fault.from_ns && now_ns < fault.to_ns;
}

const char* ToString(FaultPlace place) noexcept;
const char* ToString(FaultKind kind) noexcept;

/// How many of the place there are; `gauges`: strain channels of the rig.
int CountOf(FaultPlace place, int gauges) noexcept;

/// Whether this kind makes sense there: a thread sends no wrong scale.
bool Exists(FaultPlace place, FaultKind kind) noexcept;

/// "gauge 7 stuck", with 1-based index.
std::string Text(const Fault& fault);

}  // namespace flexarm
