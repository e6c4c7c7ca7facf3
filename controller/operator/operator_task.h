#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "controller/commissioning/commissioner.h"
#include "controller/operator/delay_monitor.h"
#include "controller/operator/operator_socket.h"
#include "controller/operator/payload_warnings.h"
#include "controller/operator/unattended_run.h"
#include "controller/realtime/task.h"
#include "controller/runlog/event_queue.h"
#include "controller/tasks/bus_health.h"
#include "controller/tasks/loop_stack.h"

namespace flexarm {

/// What the operator task needs of its daemon. All of it outlives the task.
struct OperatorContext {
  LoopStack* stack;
  EventQueue* events;  ///< to the recorder
  const Design* design;
  const RigConfig* config;
  LoopGrid grid;
  double delay_margin_s;  ///< of the design (controller/design/robustness_analysis.h)
  MotionLimits limits;
  std::string socket;                    ///< path; empty: no socket
  std::optional<Experiment> unattended;  ///< run once without a person
  /// Reads an experiment that a client sent. Throws std::exception with the reasons.
  std::function<Experiment(const std::string& text, const std::string& name)> parse_experiment;
  /// Journal: one line.
  std::function<void(bool is_error, const std::string& text)> report;
  /// Fills "threads" of the status: how the tasks kept their time.
  std::function<nlohmann::json()> thread_status;
  /// Called once a period while safety and control are alive: the service manager's watchdog.
  std::function<void(std::int64_t now_ns, const std::string& status)> alive;
};

/// The operator thread's body, 50 Hz: commands in, answers and telemetry out, journal, watchdog.
///
/// Commands are JSON objects, one a line: {"command": "arm"}. Every answer has "ok"; a refused one
/// "error" and "remedy". What changes the arm's state is judged by the safety task; the answer
/// waits for it. Not real-time safe. Thread: its own.
class OperatorTask final : public Task {
 public:
  static constexpr std::int64_t kPeriodNs = 20'000'000;

  /// @throws Refused if the socket cannot be used, or the unattended experiment is impossible
  explicit OperatorTask(OperatorContext context);
  ~OperatorTask() override;

  Traits traits() const noexcept override;
  void Run(const Activation& activation) noexcept override;

  /// Any thread: bring the arm to rest, disarm, then be `done`. Idempotent.
  void RequestShutdown() noexcept { shutdown_.store(true, std::memory_order_relaxed); }

  /// Any thread: nothing is left to do; the tasks may be stopped.
  bool done() const noexcept { return done_.load(std::memory_order_acquire); }

  // Any thread, after done().
  TripCause trip() const noexcept { return trip_.load(std::memory_order_relaxed); }
  bool refused() const noexcept { return refused_.load(std::memory_order_relaxed); }

 private:
  struct Waiting {  // a client that waits for the safety task's answer
    std::uint32_t number;
    int client;
  };

  void Serve();
  nlohmann::json Answer(const OperatorSocket::Message& message);
  nlohmann::json PressLine(const nlohmann::json& command);
  nlohmann::json StartRun(const nlohmann::json& command, int client);
  nlohmann::json StartCommissioning(const nlohmann::json& command, int client);
  nlohmann::json Status();
  void Ask(RequestKind kind, int client, LineLevels may_open = 0);
  void TakeAnswers();
  void TakeTicks();
  void WarnOfDelay();
  void WarnOfDelayFound();
  /// An event of the log and a line for the operator.
  void Warn(const std::string& name, const std::string& text, const nlohmann::json& figures);
  void WarnOfPayload(std::uint32_t warnings);
  void FinishCommissioning(nlohmann::json answer);
  /// Plans `experiment` from where the hubs are. @throws Refused
  void PlanExperiment(const Experiment& experiment, const std::array<double, 2>& start_rad);
  void Plan(std::unique_ptr<PlannedExperiment> planned, const std::string& name,
            const std::string& text);
  void FollowUnattended();
  void FollowShutdown();
  void FollowState();

  OperatorContext context_;
  std::unique_ptr<OperatorSocket> socket_;
  UnattendedRun unattended_;
  BusJournal bus_journal_;
  DelayMonitor delay_;
  FoundDelayMonitor delay_found_;
  PayloadWarnings payload_;
  Commissioner commissioner_;
  int commissioning_client_ = -1;            // -1: nobody waits
  std::uint32_t commissioning_request_ = 0;  // of its run; 0: none
  std::deque<Waiting> waiting_;
  struct LivePlan {
    std::uint32_t number;
    std::unique_ptr<PlannedExperiment> experiment;
  };
  std::deque<LivePlan> plans_;
  std::string experiment_name_;
  std::uint32_t plan_number_ = 0;
  std::uint32_t request_number_ = 1'000;  // unattended requests count from 1
  std::int64_t now_ns_ = 0;
  Permit permit_{};
  TickRecord telemetry_{};
  std::int64_t shutdown_since_ns_ = INT64_MAX;
  SafetyState shutdown_asked_in_ = SafetyState::kStarting;
  std::int64_t over_ns_ = INT64_MAX;
  std::atomic<bool> shutdown_{false};
  std::atomic<bool> done_{false};
  std::atomic<bool> refused_{false};
  std::atomic<TripCause> trip_{TripCause::kNone};
};

}  // namespace flexarm
