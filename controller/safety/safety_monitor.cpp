#include "controller/safety/safety_monitor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "controller/safety/line_filter.h"
#include "controller/safety/torque_gate.h"
#include "controller/safety/windowed_count.h"
#include "controller/types/runtime_config.h"
#include "controller/types/safety_config.h"

namespace flexarm {
namespace {

struct Switch {
  Line line;
  TripCause cause;
  std::uint32_t joint;
};

constexpr std::array<Switch, 5> kSwitches{{
    {Line::kLimit1Low, TripCause::kLimitSwitch1Low, 1},
    {Line::kLimit1High, TripCause::kLimitSwitch1High, 1},
    {Line::kLimit2Low, TripCause::kLimitSwitch2Low, 2},
    {Line::kLimit2High, TripCause::kLimitSwitch2High, 2},
    {Line::kEmergencyStop, TripCause::kEmergencyStop, 0},
}};

constexpr LineLevels kLimitLines = LineBit(Line::kLimit1Low) | LineBit(Line::kLimit1High) |
                                   LineBit(Line::kLimit2Low) | LineBit(Line::kLimit2High);

constexpr std::uint8_t Flag(bool set) noexcept { return set ? 1 : 0; }

constexpr double Seconds(std::int64_t ns) noexcept { return static_cast<double>(ns) * 1e-9; }

bool ControlReported(const SafetyInputs& in) noexcept { return in.control.tick >= 0; }
bool DriveReported(const SafetyInputs& in) noexcept { return in.drive.due_ns != INT64_MIN; }

}  // namespace

static_assert(kLongestWindow <= WindowedCount::kLongest);

MonitorLimits MakeMonitorLimits(const SafetyConfig& safety, const LoopConfig& loop,
                                bool late_threads_trip,
                                const std::optional<DriveVoltageTimes>& voltage) {
  MonitorLimits limits{.heartbeat_timeout_ns = std::llround(2e6 * loop.period_ms),
                       .stop_timeout_ns = std::llround(1e9 * safety.stop_timeout_s),
                       .fault_stop_ns = std::llround(1e9 * safety.fault_stop_s),
                       .missed_deadlines_to_trip = safety.missed_deadlines_to_trip,
                       .homing_contact_ns = std::llround(1e9 * safety.homing_contact_s),
                       .lines_stall_ns = std::llround(1e6 * safety.permit_timeout_ms),
                       .overrun_ns = std::llround(1e6 * safety.overrun_to_trip_ms),
                       .missed_in_window = safety.missed_deadlines_in_window,
                       .failed_in_window = safety.failed_exchanges_in_window,
                       .slow_in_window = safety.slow_exchanges_in_window,
                       .late_threads_trip = late_threads_trip};
  if (voltage) {
    limits.power = {.rise_ns = std::llround(1e6 * voltage->rise_ms),
                    .fall_ns = std::llround(1e6 * voltage->fall_ms),
                    .report_ns = std::llround(3e6 * loop.period_ms)};
  }
  return limits;
}

bool SafetyMonitor::HomingContact(const SafetyInputs& in) noexcept {
  const std::int64_t since_ns = std::exchange(looked_ns_, in.due_ns);
  if (in.state != SafetyState::kRunning || in.may_open == 0) {
    contact_ns_ = 0;
    return false;
  }
  if ((~in.levels & in.may_open) == 0) return false;
  contact_ns_ += in.due_ns - since_ns;  // a tick that is late counts for the time since the last
  return contact_ns_ <= limits_.homing_contact_ns;
}

std::int64_t SafetyMonitor::StateLimitNs(SafetyState state) const noexcept {
  if (state == SafetyState::kStopping) return limits_.stop_timeout_ns;
  if (state == SafetyState::kFaultStopping) return limits_.fault_stop_ns;
  return state == SafetyState::kDisarming ? kDisarmNs : INT64_MAX;
}

bool SafetyMonitor::LinesFail(const SafetyInputs& in) noexcept {
  const bool calls_fail = line_calls_.Judge(in.line_calls);
  const bool relay_fails = relay_.Judge(in.due_ns, RelayClosed(in.state), in.relay);
  const bool power_fails = power_path_.Judge({.due_ns = in.due_ns,
                                              .state = in.state,
                                              .state_since_ns = in.state_since_ns,
                                              .voltage = in.drive.voltage,
                                              .reported_ns = in.drive.due_ns});
  lines_evidence_ = calls_fail    ? LineCallMonitor::EvidenceOf(in.line_calls)
                    : relay_fails ? relay_.evidence()
                                  : power_path_.evidence();
  return calls_fail || relay_fails || power_fails;
}

bool SafetyMonitor::MayDamp(const SafetyInputs& in, TripCauses present,
                            bool control_alive) noexcept {
  const TripCauses before = std::exchange(present_before_, present);
  if (in.state != SafetyState::kFaultStopping) {
    fault_causes_ = 0;
  } else if (fault_causes_ == 0) {
    fault_causes_ = before;
  }
  const bool further = fault_causes_ != 0 && (present & ~fault_causes_) != 0;
  return limits_.fault_stop_ns > 0 && control_alive && in.control.may_damp &&
         in.drive.power == DrivePower::kOn && !further;
}

TripCauses SafetyMonitor::LateThreads(const SafetyInputs& in, bool control_alive) noexcept {
  TripCauses late = 0;
  if (in.permit_age_ns > limits_.overrun_ns) late |= CauseBit(TripCause::kSafetyOverrun);
  if (control_alive && in.control.missed_in_a_row >= limits_.missed_deadlines_to_trip) {
    late |= CauseBit(TripCause::kMissedDeadlines);
  }
  if (control_alive && in.control.missed_in_window >= limits_.missed_in_window) {
    late |= CauseBit(TripCause::kDeadlinesOftenMissed);
  }
  const TripCauses begun = late & ~std::exchange(late_before_, late);
  // Each late tick is an overrun of its own; a deadline that was missed stays in several reports.
  if ((late & CauseBit(TripCause::kSafetyOverrun)) != 0) ++timing_.safety_overruns;
  if ((begun & CauseBit(TripCause::kMissedDeadlines)) != 0) ++timing_.deadlines_missed;
  if ((begun & CauseBit(TripCause::kDeadlinesOftenMissed)) != 0) ++timing_.deadlines_often_missed;
  timing_.oldest_permit_ns = std::max(timing_.oldest_permit_ns, in.permit_age_ns);
  return late;
}

// Counted from the first tick that sees the shutdown, so that it holds whatever other threads
// do.
bool SafetyMonitor::ShutdownExpired(const SafetyInputs& in) noexcept {
  if (!in.shutting_down) return false;
  if (shutdown_since_ns_ == INT64_MIN) shutdown_since_ns_ = in.due_ns;
  return RelayClosed(in.state) && AgeNs(in.due_ns, shutdown_since_ns_) > ShutdownLimitNs();
}

SafetyFacts SafetyMonitor::Judge(const SafetyInputs& in) noexcept {
  SafetyFacts facts{};
  const auto add = [&facts](TripCause cause) { facts.present |= CauseBit(cause); };

  const LineLevels excused = HomingContact(in) ? in.may_open & kLimitLines : 0;
  for (const Switch& s : kSwitches) {
    if (!in.levels_known) continue;
    if (((in.levels | excused) & LineBit(s.line)) == 0) add(s.cause);  // normally closed
  }
  if (LinesFail(in)) add(TripCause::kSafetyLines);

  const bool control_alive =
      ControlReported(in) && AgeNs(in.due_ns, in.control_alive_ns) <= limits_.heartbeat_timeout_ns;
  if (control_alive) {
    facts.present |= in.control.faults;
  } else if (ControlReported(in)) {
    add(TripCause::kControlHeartbeatLost);
  }

  const TripCauses late = LateThreads(in, control_alive);
  if (limits_.late_threads_trip) facts.present |= late;
  if (ShutdownExpired(in)) add(TripCause::kShutdownTimeout);

  if (DriveReported(in)) {
    if (AgeNs(in.due_ns, in.drive_alive_ns) > limits_.heartbeat_timeout_ns) {
      add(TripCause::kStaleFrame);
    }
    if (!in.drive.bus_ok) add(TripCause::kBusLost);
    if (!in.drive.drive_ok) add(TripCause::kDriveFault);
    if (in.drive.failed_in_window >= limits_.failed_in_window) add(TripCause::kBusUnreliable);
    if (in.drive.slow_in_window >= limits_.slow_in_window) add(TripCause::kBusTooSlow);
  }

  all_reported_ = all_reported_ || (in.levels_known && ControlReported(in) && DriveReported(in));
  facts.all_reported = Flag(all_reported_);
  // A report from before the stop must not end Stopping.
  const bool stops = in.state == SafetyState::kStopping || in.state == SafetyState::kFaultStopping;
  const bool heard_here = !stops || in.control.due_ns > in.state_since_ns;
  facts.at_rest = Flag(control_alive && in.control.at_rest && heard_here);
  facts.experiment_done =
      Flag(control_alive && in.control.experiment_done && in.state == SafetyState::kRunning &&
           in.control.due_ns > in.running_since_ns);
  const std::int64_t limit_ns = StateLimitNs(in.state);
  facts.stop_expired =
      Flag(limit_ns != INT64_MAX && AgeNs(in.due_ns, in.state_since_ns) > limit_ns);
  facts.may_damp = Flag(MayDamp(in, facts.present, control_alive));
  facts.drives_on = Flag(in.drive.power == DrivePower::kOn);
  facts.drives_off =
      Flag(in.drive.power == DrivePower::kOff && in.drive.due_ns > in.state_since_ns);

  facts.tests_power = Flag(limits_.power.witness());
  facts.power_follows = Flag(relay_.agrees() && power_path_.follows());

  const bool button_down = (in.levels & LineBit(Line::kResetButton)) != 0;
  // A press counts when it has lasted for kPressNs: one that began before the trip is no answer.
  const bool pressed_now = button_down && !button_was_down_ &&
                           AgeNs(in.due_ns, in.state_since_ns) >= LineFilter::kPressNs;
  button_was_down_ = button_down;
  reset_pressed_ = in.state == SafetyState::kTripped && (reset_pressed_ || pressed_now);
  facts.reset_pressed = Flag(reset_pressed_);

  facts.request = in.request;
  facts.shutting_down = Flag(in.shutting_down);
  return facts;
}

Evidence SafetyMonitor::EvidenceOf(TripCause cause, const SafetyInputs& in) const noexcept {
  const auto evidence = [](double value, double limit, std::uint32_t channel) {
    return Evidence{.value = value, .limit = limit, .channel = channel, .detail = 0};
  };
  const auto of_bus = [](double value, double limit, const DriveTroubles::Trouble& trouble) {
    return Evidence{
        .value = value, .limit = limit, .channel = trouble.bus, .detail = ToBits(trouble.fault)};
  };
  for (const Switch& s : kSwitches) {
    if (s.cause == cause && (in.levels & LineBit(s.line)) == 0) return evidence(0.0, 1.0, s.joint);
  }
  if (in.control.faults != 0 && LowestCause(in.control.faults) == cause) return in.control.evidence;
  if (cause == TripCause::kSafetyLines) return lines_evidence_;
  if (cause == TripCause::kStaleFrame) {
    return of_bus(Seconds(AgeNs(in.due_ns, in.drive_alive_ns)),
                  Seconds(limits_.heartbeat_timeout_ns),
                  {in.troubles.oldest_bus, {.kind = kBusHangs}});
  }
  if (cause == TripCause::kBusLost) return of_bus(0.0, 1.0, in.troubles.lost);
  if (cause == TripCause::kDriveFault) return of_bus(0.0, 1.0, in.troubles.drive);
  if (cause == TripCause::kBusUnreliable) {
    return of_bus(in.drive.failed_in_window, limits_.failed_in_window, in.troubles.unreliable);
  }
  if (cause == TripCause::kBusTooSlow) {
    return of_bus(in.drive.slow_in_window, limits_.slow_in_window, in.troubles.slow);
  }
  if (cause == TripCause::kSafetyOverrun) {
    return evidence(Seconds(in.permit_age_ns), Seconds(limits_.overrun_ns), 0);
  }
  if (cause == TripCause::kDeadlinesOftenMissed) {
    return evidence(in.control.missed_in_window, limits_.missed_in_window, 0);
  }
  if (cause == TripCause::kShutdownTimeout) {
    return evidence(Seconds(AgeNs(in.due_ns, shutdown_since_ns_)), Seconds(ShutdownLimitNs()), 0);
  }
  if (cause == TripCause::kMissedDeadlines) {
    return evidence(in.control.missed_in_a_row, limits_.missed_deadlines_to_trip, 0);
  }
  if (cause == TripCause::kControlHeartbeatLost) {
    return evidence(Seconds(AgeNs(in.due_ns, in.control_alive_ns)),
                    Seconds(limits_.heartbeat_timeout_ns), 0);
  }
  if (cause == TripCause::kStopTimeout) {
    return evidence(Seconds(AgeNs(in.due_ns, in.state_since_ns)), Seconds(limits_.stop_timeout_ns),
                    0);
  }
  return evidence(0.0, 0.0, 0);
}

}  // namespace flexarm
