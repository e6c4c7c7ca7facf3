#pragma once

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <utility>
#include <vector>

#include "controller/realtime/lockstep_executor.h"
#include "controller/safety/torque_gate.h"
#include "controller/tasks/safety_task.h"
#include "tests/support/loop_time.h"

// The safety task with simulated control and drive tasks that can be stopped, in lock step.

namespace flexarm {

inline constexpr std::int64_t kPhaseNs = 5 * kMs;
inline constexpr std::int64_t kDeadlineNs = 10 * kMs;
inline constexpr MonitorLimits kLimits{.heartbeat_timeout_ns = 2 * kPeriodNs,
                                       .stop_timeout_ns = 3000 * kMs,
                                       .fault_stop_ns = 500 * kMs,
                                       .missed_deadlines_to_trip = 3,
                                       .homing_contact_ns = 500 * kMs,
                                       .lines_stall_ns = 5 * kMs,
                                       .overrun_ns = 5 * kMs,
                                       .missed_in_window = 16,
                                       .failed_in_window = 16,
                                       .slow_in_window = 16};

/// With the drives' voltage as a witness of the power path.
inline constexpr MonitorLimits kWitnessLimits = [] {
  MonitorLimits limits = kLimits;
  limits.power = {.rise_ns = 60 * kMs, .fall_ns = 80 * kMs, .report_ns = 60 * kMs};
  return limits;
}();

struct FakeLines final : SafetyLines {
  struct Written {
    std::int64_t now_ns;
    Outputs outputs;
  };

  Reading Read(std::int64_t) noexcept override {
    return {.levels = levels, .call = read, .relay = relay};
  }
  Call Write(std::int64_t now_ns, const Outputs& outputs) noexcept override {
    if (!written.empty() && written.back().outputs.pump_level != outputs.pump_level) {
      pump_toggled_ns = now_ns;
    }
    written.push_back({now_ns, outputs});
    return write;
  }
  void HoldOff() noexcept override { ADD_FAILURE() << "only a crash does so"; }
  /// Power for the drives, through relay and pump in series.
  bool power(std::int64_t now_ns) const {
    const bool closed = !written.empty() && relay_closed();
    return (closed || welded) && (now_ns - pump_toggled_ns <= kPumpTimeoutNs || pump_stuck);
  }
  bool relay_closed() const { return written.back().outputs.relay_closed; }

  LineLevels levels = kHealthyLevels;
  Call read, write;  // how the calls go
  RelayContact relay = RelayContact::kNone;
  bool welded = false;      // the relay's main contact stays closed
  bool pump_stuck = false;  // the monostable of the charge pump stays on
  std::int64_t pump_toggled_ns = -1'000 * kMs;
  std::vector<Written> written;
};

struct FakeControl final : Task {
  explicit FakeControl(ControlReportChannel* out) : out_(out) {}
  Traits traits() const noexcept override {
    return {.name = "control",
            .period_ns = kPeriodNs,
            .phase_ns = kPhaseNs,
            .deadline_ns = kDeadlineNs,
            .priority = 80};
  }
  void Run(const Activation& activation) noexcept override {
    if (stopped) return;
    report.tick = (activation.due_ns - kPhaseNs) / kPeriodNs;
    report.due_ns = activation.due_ns;
    history_.Push(activation.due_ns + kDeadlineNs, report);
    out_->Publish(history_);
  }

  bool stopped = false;
  ControlReport report = [] {
    ControlReport initial = kNoControlReport;
    initial.at_rest = true;
    return initial;
  }();

 private:
  ControlReportHistory history_{kNoControlReport};
  ControlReportChannel* out_;
};

// Applies the torque after the gate, like the plant task.
struct FakeDrive final : Task {
  FakeDrive(PermitChannel* permits, DriveReportChannel* out) : permits_(permits), out_(out) {}
  Traits traits() const noexcept override {
    return {.name = "drive", .period_ns = kMs, .phase_ns = 0, .deadline_ns = kMs, .priority = 60};
  }
  void Run(const Activation& activation) noexcept override {
    if (stopped) return;
    const Permit& permit = permits_->Read().At(activation.due_ns - 1).value;
    const GateLimits limits{.torque_nm = {30.0, 6.0},
                            .slew_nm_per_s = {500.0, 150.0},
                            .command_timeout_ns = 2 * kPeriodNs,
                            .permit_timeout_ns = 5 * kMs,
                            .homing_fraction = 1.0,
                            .reduced_fraction = 1.0};
    const GateResult result = Gate({.asked_nm = {1.0, 1.0},
                                    .asked_age_ns = 0,  // commands never age: only the permit acts
                                    .permit = permit.state,
                                    .homing = false,
                                    .reduced = false,
                                    .permit_age_ns = AgeNs(activation.due_ns, permit.renewed_ns),
                                    .previous_nm = torque_nm,
                                    .dt_s = 1e-3},
                                   limits);
    torque_nm = result.torque_nm;
    report.due_ns = activation.due_ns;
    const bool on = !stuck_off && (stuck_on || DrivesEnabled(permit.state));
    report.power = on ? DrivePower::kOn : DrivePower::kOff;
    if (supply != nullptr) report.voltage = Voltage(activation.due_ns);
    history_.Push(activation.due_ns + kMs, report);
    out_->Publish(history_);
  }

  bool stopped = false;
  bool stuck_on = false, stuck_off = false;  // what it reports
  std::array<double, 2> torque_nm{};
  DriveReport report{.due_ns = INT64_MIN, .bus_ok = true, .drive_ok = true};
  const FakeLines* supply = nullptr;  // its voltage is reported; none: it is not
  bool mains = true;
  std::uint8_t silent = 0;     // drives whose voltage is not known, as bits
  std::uint8_t always_up = 0;  // drives with voltage whatever the supply does

 private:
  // A DC link, which takes its time.
  DriveVoltage Voltage(std::int64_t now_ns) {
    const bool fed = mains && supply->power(now_ns);
    if (fed != std::exchange(fed_, fed)) fed_since_ns_ = now_ns;
    if (now_ns - fed_since_ns_ >= (fed ? 30 : 40) * kMs) up_ = fed;
    const auto known = static_cast<std::uint8_t>(0b11 & ~silent);
    const auto on = static_cast<std::uint8_t>(known & (up_ ? 0b11 : always_up));
    return {.on = on, .off = static_cast<std::uint8_t>(known & ~on)};
  }

  bool fed_ = false, up_ = false;
  std::int64_t fed_since_ns_ = 0;
  DriveReportHistory history_{kNoDriveReport};
  PermitChannel* permits_;
  DriveReportChannel* out_;
};

// A task whose thread may wake late: it skips whole periods, as under RealtimeExecutor.
struct LateTask final : Task {
  explicit LateTask(Task* task) : task_(task) {}
  Traits traits() const noexcept override { return task_->traits(); }
  void Run(const Activation& activation) noexcept override {
    if (delay_ns >= traits().period_ns) {
      delay_ns -= traits().period_ns;
      ++skipped_;
      return;
    }
    task_->Run({.due_ns = activation.due_ns, .missed_in_a_row = skipped_, .late_ns = delay_ns});
    delay_ns = 0;
    skipped_ = 0;
  }

  std::int64_t delay_ns = 0;  // of the next activation

 private:
  Task* task_;
  int skipped_ = 0;
};

class SafetyTaskTest : public testing::Test {
 protected:
  /// @param others  reports of further buses, which have no task here
  explicit SafetyTaskTest(const MonitorLimits& limits = kLimits,
                          const std::vector<DriveReportChannel*>& others = {})
      : limits_(limits), buses_([&] {
          std::vector<DriveReportChannel*> all{&drive_reports_};
          all.insert(all.end(), others.begin(), others.end());
          return all;
        }()) {
    executor_.Add(drive_);
    executor_.Add(control_);
    executor_.Add(late_);
  }

  void RunFor(std::int64_t duration_ns) { executor_.RunUntil(executor_.next_ns() + duration_ns); }

  std::uint32_t Ask(RequestKind kind, std::int64_t not_before_ns = INT64_MIN,
                    const RunOrder& run = {}) {
    EXPECT_TRUE(requests_.Push(
        {.kind = kind, .number = ++number_, .not_before_ns = not_before_ns, .run = run}));
    return number_;
  }

  // Sends a request, runs one tick and returns the answer.
  Refusal Now(RequestKind kind) {
    const std::uint32_t number = Ask(kind);
    RunFor(kMs);
    RequestAnswer answer{};
    while (answers_.Pop(&answer)) {
      if (answer.number == number) return answer.refusal;
    }
    ADD_FAILURE() << "no answer to " << ToString(kind);
    return Refusal::kNone;
  }

  void GoTo(SafetyState state) {
    RunFor(100 * kMs);
    ASSERT_EQ(safety_.status().state, SafetyState::kIdle);
    if (state == SafetyState::kIdle) return;
    ASSERT_EQ(Now(RequestKind::kArm), Refusal::kNone);
    RunFor(5 * kMs);  // the drive confirms that it is on
    if (state == SafetyState::kArmed) return;
    ASSERT_EQ(Now(RequestKind::kRun), Refusal::kNone);
    control_.report.at_rest = false;
    RunFor(200 * kMs);
    ASSERT_EQ(safety_.status().state, SafetyState::kRunning);
    ASSERT_EQ(drive_.torque_nm[0], 1.0);
  }

  // Runs until the trip. @returns its instant
  std::int64_t RunUntilTripped(std::int64_t at_most_ns) {
    const std::int64_t end_ns = executor_.next_ns() + at_most_ns;
    while (safety_.status().state != SafetyState::kTripped && executor_.next_ns() < end_ns)
      RunFor(kMs);
    EXPECT_EQ(safety_.status().state, SafetyState::kTripped);
    return executor_.next_ns() - kMs;
  }

  std::vector<SafetyRecord> Records() {
    SafetyRecord record{};
    while (records_.Pop(&record)) all_records_.push_back(record);
    return all_records_;
  }

  // Presses and releases the button, and resets.
  Refusal Reset() {
    control_.report.at_rest = true;
    control_.report.faults = 0;
    lines_.levels |= LineBit(Line::kResetButton);
    RunFor(100 * kMs);
    lines_.levels = kHealthyLevels;
    RunFor(kMs);
    return Now(RequestKind::kReset);
  }

  const Permit& permit() { return operator_permits_.Read().Newest().value; }

  const MonitorLimits limits_;
  FakeLines lines_;
  ControlReportChannel reports_{ControlReportHistory(kNoControlReport)};
  DriveReportChannel drive_reports_{DriveReportHistory(kNoDriveReport)};
  const std::vector<DriveReportChannel*> buses_;
  PermitChannel drive_permits_{PermitHistory(kNoPermit)};
  PermitChannel operator_permits_{PermitHistory(kNoPermit)};
  SpscQueue<OperatorRequest> requests_{100};
  LatchedRequest stop_, disarm_;
  std::atomic<bool> shutting_down_{false};
  std::atomic<bool> reduced_{false};
  Wakeup wakeup_;
  SpscQueue<RequestAnswer> answers_{100};
  SpscQueue<SafetyRecord> records_{10'000};
  TimingChannel timing_{TimingCounts{}};
  PresentCausesChannel present_{PresentCauses{}};
  SafetyTask safety_{limits_,
                     {.lines = &lines_,
                      .control = &reports_,
                      .drives = buses_,
                      .requests = &requests_,
                      .stop = &stop_,
                      .disarm = &disarm_,
                      .shutting_down = &shutting_down_,
                      .reduced = &reduced_,
                      .wakeups = {&wakeup_},
                      .permits = {&drive_permits_, &operator_permits_},
                      .answers = &answers_,
                      .records = &records_,
                      .timing = &timing_,
                      .present = &present_}};
  LateTask late_{&safety_};
  FakeControl control_{&reports_};
  FakeDrive drive_{&drive_permits_, &drive_reports_};
  LockstepExecutor executor_;
  std::uint32_t number_ = 0;
  std::vector<SafetyRecord> all_records_;
};

}  // namespace flexarm
