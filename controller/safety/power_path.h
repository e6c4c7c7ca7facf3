#pragma once

#include <cstdint>

#include "controller/types/messages.h"
#include "controller/types/safety_state.h"
#include "controller/types/trip_cause.h"
#include "hal/drive_voltage.h"

namespace flexarm {

/// Times of the drives' voltage as a witness of the power path.
struct PowerPathLimits {
  std::int64_t rise_ns = 0;  ///< hal.gpiod.drive_voltage.rise_ms; 0: the voltage is no witness
  std::int64_t fall_ns = 0;  ///< hal.gpiod.drive_voltage.fall_ms
  std::int64_t report_ns =
      0;  ///< a report of the drives comes so late, one failed exchange included

  constexpr bool witness() const noexcept { return rise_ns > 0; }
};

/// Judges whether the drives' voltage does what relay and charge pump, in series, should make of
/// it: the cause `safety-lines`.
///
/// - Both closed: every drive has voltage within the rise time.
/// - Both open: no drive has voltage after the fall time.
/// - One alone, in the tests of the arming: a drive that has voltage shows at once that the other
///   channel is stuck. The test has passed when every drive reports no voltage, in an exchange that
///   began a whole rise time after the test.
///
/// A voltage that is not known proves nothing: it ends no test, and a test that does not end within
/// rise time and report fails. In the other states the bus that does not report is a cause itself.
/// Pure, without a clock. Real-time: safe.
class PowerPathMonitor {
 public:
  static constexpr std::uint8_t kEveryDrive = 0b11;

  struct Inputs {
    std::int64_t due_ns;
    SafetyState state;  ///< before this tick: relay and pump are as it says
    std::int64_t state_since_ns;
    DriveVoltage voltage;
    std::int64_t reported_ns;  ///< begin of the exchange that reports it
  };

  explicit constexpr PowerPathMonitor(const PowerPathLimits& limits) noexcept : limits_(limits) {}

  /// Once per tick. @returns true while the power path cannot be relied upon
  constexpr bool Judge(const Inputs& in) noexcept {
    evidence_ = {};
    if (!limits_.witness()) return false;
    const bool powered = RelayClosed(in.state) && PumpRuns(in.state);
    const bool alone = TestsPower(in.state) && !powered;
    const bool settled = !alone || in.reported_ns >= in.state_since_ns + limits_.rise_ns;
    follows_ = powered ? in.voltage.on == kEveryDrive : in.voltage.off == kEveryDrive && settled;
    const bool contradicts = (powered ? in.voltage.off : in.voltage.on) != 0;
    if (!contradicts || agreed_ns_ == INT64_MIN) agreed_ns_ = in.due_ns;

    const std::int64_t lasts_ns = in.due_ns - agreed_ns_;
    const std::int64_t limit_ns = (powered ? limits_.rise_ns : limits_.fall_ns) + limits_.report_ns;
    if (contradicts && alone) return Fails(TroubleOf(in.state), in.due_ns - in.state_since_ns, 0);
    if (lasts_ns > limit_ns) return Fails(TroubleOf(in.state), lasts_ns, limit_ns);
    const std::int64_t test_ns = limits_.rise_ns + limits_.report_ns;
    if (TestsPower(in.state) && !follows_ && in.due_ns - in.state_since_ns > test_ns) {
      return Fails(LineTrouble::kVoltageUnknown, in.due_ns - in.state_since_ns, test_ns);
    }
    return false;
  }

  /// Of the last tick: the voltage is known to be what relay and pump should make of it; true
  /// without a witness.
  constexpr bool follows() const noexcept { return follows_; }

  /// Of the last tick, if it fails: how long the voltage has been wrong, and may be, in s.
  constexpr Evidence evidence() const noexcept { return evidence_; }

 private:
  static constexpr LineTrouble TroubleOf(SafetyState state) noexcept {
    if (state == SafetyState::kTestingPump) return LineTrouble::kRelayStuckClosed;
    if (state == SafetyState::kTestingRelay) return LineTrouble::kPumpStuckOn;
    return RelayClosed(state) ? LineTrouble::kVoltageMissing : LineTrouble::kVoltageStaysOn;
  }

  constexpr bool Fails(LineTrouble trouble, std::int64_t value_ns, std::int64_t limit_ns) noexcept {
    evidence_ = {.value = static_cast<double>(value_ns) * 1e-9,
                 .limit = static_cast<double>(limit_ns) * 1e-9,
                 .channel = static_cast<std::uint32_t>(trouble),
                 .detail = 0};
    return true;
  }

  PowerPathLimits limits_;
  std::int64_t agreed_ns_ =
      INT64_MIN;  // the last tick without contradiction; INT64_MIN: no tick yet
  bool follows_ = true;
  Evidence evidence_{};
};

}  // namespace flexarm
