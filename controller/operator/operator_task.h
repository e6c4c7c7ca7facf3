#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "controller/operator/arm_command.h"
#include "controller/operator/auto_disarm.h"
#include "controller/operator/bus_counter_record.h"
#include "controller/operator/change_command.h"
#include "controller/operator/command_dispatch.h"
#include "controller/operator/command_record.h"
#include "controller/operator/commissioning_commands.h"
#include "controller/operator/experiment_loader.h"
#include "controller/operator/lease.h"
#include "controller/operator/loop_watch.h"
#include "controller/operator/operator_context.h"
#include "controller/operator/operator_snapshot.h"
#include "controller/operator/operator_socket.h"
#include "controller/operator/override_record.h"
#include "controller/operator/prove_switches.h"
#include "controller/operator/request_tracker.h"
#include "controller/operator/run_command.h"
#include "controller/operator/run_warnings.h"
#include "controller/operator/run_watch.h"
#include "controller/operator/shutdown.h"
#include "controller/operator/state_journal.h"
#include "controller/operator/timing_warnings.h"
#include "controller/operator/trip_circumstances.h"
#include "controller/operator/unattended_run.h"
#include "controller/realtime/task.h"
#include "controller/tasks/bus_health.h"

namespace flexarm {

/// The operator thread's body, 50 Hz (commands 100 Hz): commands in, answers and status out,
/// journal, watchdog.
///
/// Fixes the order of effects within a period; each of them has a class of its own. The commands:
/// command_dispatch.h. What changes the arm's state is decided by the safety task, whose answer is
/// passed on to the client. Not real-time safe. Thread: its own.
class OperatorTask final : public Task {
 public:
  static constexpr std::int64_t kPeriodNs = 20'000'000;
  /// Commands are also read between two periods, so that a stop waits for 10 ms at most.
  static constexpr std::int64_t kLookNs = kPeriodNs / 2;

  /// @throws RejectedError if the socket cannot be used, or the unattended experiment is impossible
  ///         or its arm request would be refused
  /// @throws InputError if the calibration file is not for these sensors
  explicit OperatorTask(OperatorContext context);
  ~OperatorTask() override;

  Traits traits() const noexcept override;
  void Run(const Activation& activation) noexcept override;

  /// Any thread: the safety task brings the arm to rest and disarms it, then this task is `done`.
  /// Idempotent.
  void RequestShutdown() noexcept {
    context_.stack->RequestShutdown();
    shutdown_requested_.store(true, std::memory_order_relaxed);
  }

  /// Any thread: nothing is left to do; the tasks may be stopped.
  bool done() const noexcept { return done_.load(std::memory_order_acquire); }

  // Any thread, after done().
  /// The trip that has not been reset; kNone: none.
  TripCause trip() const noexcept { return trip_.load(std::memory_order_relaxed); }
  bool refused() const noexcept { return refused_.load(std::memory_order_relaxed); }

 private:
  void RequireArm() const;
  void Follow();
  void FollowState();
  void FollowBuses();
  void TakeTicks();
  void TakeAnswers();
  void Take(const RequestAnswer& answer);
  void FollowLatch();
  void FollowLog();
  void FollowAutoDisarm();
  bool LogReady();
  void Serve();
  void FollowUnattended();
  void BeginShutdown();
  void FollowShutdown();
  const nlohmann::json& Status();
  std::string TripReportFile() const;
  void Reply(int client, nlohmann::json answer);
  void Reply(std::optional<ClientAnswer> answer);

  OperatorContext context_;
  OperatorSnapshot now_;
  RequestTracker requests_;
  ExperimentLoader experiments_;
  std::optional<ExperimentLoader::Order> unattended_order_;
  CommissioningCommands commissioning_;
  ProveSwitches switches_;
  OverrideRecord overrides_;
  ArmCommand arm_;
  RunCommand run_;
  ChangeCommand change_;
  RunWatch run_watch_;
  RunWarnings warnings_;
  StateJournal state_journal_;
  TripCircumstances circumstances_;
  LoopWatch loop_watch_;
  BusJournal bus_journal_;
  BusCounterRecord bus_counters_;
  TimingWarnings timing_warnings_;
  CommandRecord record_;
  Lease lease_;
  CommandDispatch dispatch_;
  UnattendedRun unattended_;
  AutoDisarm auto_disarm_;
  Shutdown shutdown_;
  std::unique_ptr<OperatorSocket> socket_;
  std::atomic<bool> shutdown_requested_{false};
  std::atomic<bool> done_{false};
  std::atomic<bool> refused_{false};
  std::atomic<TripCause> trip_{TripCause::kNone};
  bool log_ready_ = false;                      // of the unattended run
  std::int64_t trip_log_until_ns_ = INT64_MIN;  // the reserved file stays until then
  double look_began_us_ = 0.0;                  // processor time of the thread
  nlohmann::json status_;                       // of the look at
  std::int64_t status_ns_ = INT64_MIN;
  std::int64_t followed_ns_ = INT64_MIN;  // the last period
};

}  // namespace flexarm
