#include "controller/host/daemon.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>
#include <vector>

#include "controller/design/design_verdict.h"
#include "controller/design/run_design.h"
#include "controller/health/health_monitor.h"
#include "controller/host/arm_verdicts.h"
#include "controller/host/check_host.h"
#include "controller/host/crash_handler.h"
#include "controller/host/daemon_identity.h"
#include "controller/host/journal.h"
#include "controller/host/run_info.h"
#include "controller/host/service_manager.h"
#include "controller/host/signal_effects.h"
#include "controller/latch/trip_latch.h"
#include "controller/law/design.h"
#include "controller/operator/operator_task.h"
#include "controller/realtime/alternate_stack.h"
#include "controller/realtime/clock.h"
#include "controller/realtime/lockstep_task.h"
#include "controller/realtime/realtime_executor.h"
#include "controller/realtime/realtime_setup.h"
#include "controller/runlog/build_info.h"
#include "controller/runlog/recorder_task.h"
#include "controller/runlog/run_recovery.h"
#include "controller/runlog/run_writer.h"
#include "controller/tasks/simulated_stack.h"
#include "controller/tasks/wired_stack.h"
#include "controller/telemetry/telemetry.h"
#include "controller/types/rejected_error.h"
#include "hal/wired/hardware_rig.h"

namespace flexarm {
namespace {

// Threads are started before instant 0. Each locks its stack, and on a busy machine this thread
// gets a share of a processor: 133 ms were seen.
constexpr std::int64_t kEpochLeadNs = 500'000'000;
constexpr std::size_t kEventDepth = 256;
constexpr std::size_t kTimingDepth = 4'000;  // 60 s of the control task
constexpr int kHighestPriority = SafetyTask::kPriority;

std::vector<TaskStatistics> Statistics(const RealtimeExecutor& executor) {
  std::vector<TaskStatistics> all;
  for (std::size_t i = 0; i < executor.size(); ++i) all.push_back(executor.statistics(i));
  return all;
}

nlohmann::json ThreadStatus(const RealtimeExecutor& executor) {
  nlohmann::json threads = nlohmann::json::array();
  for (const TaskStatistics& s : Statistics(executor)) {
    threads.push_back({{"name", s.name},
                       {"activations", s.activations},
                       {"missed_deadlines", s.missed_deadlines},
                       {"skipped_periods", s.skipped_periods},
                       {"worst_lateness_us", static_cast<double>(s.worst_lateness_ns) * 1e-3},
                       {"mean_lateness_us", s.mean_lateness_ns * 1e-3},
                       {"worst_run_us", static_cast<double>(s.worst_run_ns) * 1e-3}});
  }
  return threads;
}

/// Backend of the loop: the simulated arm in process, or the devices of a hardware rig.
struct Backend {
  std::unique_ptr<HardwareRig> rig;  // outlives the stack
  std::unique_ptr<LoopStack> stack;
};

// Opens the devices of a hardware rig: identifies and configures them, and reads the settings back.
Backend MakeBackend(const DaemonOptions& options, const Design& design) {
  const RigConfig& config = options.config;
  Backend backend;
  if (options.config.backend == "sim") {
    backend.stack = std::make_unique<SimulatedStack>(config, design, config.arm.payload_mass_kg);
  } else {
    backend.rig = std::make_unique<HardwareRig>(
        config.hal, BusClocks{.monotonic_ns = MonotonicNow, .realtime_ns = RealtimeNow});
    backend.stack = std::make_unique<WiredStack>(
        config, design, RigWires{.buses = backend.rig->buses(), .lines = backend.rig->lines()});
  }
  return backend;
}

void HoldLinesOff(void* stack) noexcept { static_cast<LoopStack*>(stack)->HoldLinesOff(); }

std::unique_ptr<Telemetry> MakeTelemetry(const RigConfig& config) {
  if (config.telemetry.address.empty()) return nullptr;
  return std::make_unique<Telemetry>(
      config.telemetry,
      TelemetrySource{
          .rig = config.rig_name, .sensors = config.sensors, .layout = config.controller.nominal});
}

// The payload that a run states is that of the config.
std::unique_ptr<HealthMonitor> MakeHealthMonitor(const RigConfig& config, Journal* journal) {
  if (!config.health.enabled || config.estimator.kind == EstimatorKind::kIdeal) return nullptr;
  const ControlConfig& control = config;
  return std::make_unique<HealthMonitor>(HealthMonitorSettings{
      .config = control,
      .health = config.health,
      .plant = {.payload_kg = config.arm.payload_mass_kg,
                .motor_lag_s = {1e-3 * config.sim.motor_lag_ms[0],
                                1e-3 * config.sim.motor_lag_ms[1]},
                .drift = {}},
      .file = std::filesystem::path(config.daemon.state_directory) / kHealthFileName,
      .report = [journal](bool is_error,
                          const std::string& text) { journal->Report(is_error, text); },
      .utc_now = UtcNow});
}

bool ChangesPayload(const PlannedExperiment* run) {
  return run != nullptr && std::ranges::any_of(run->sim_events, [](const SimEvent& event) {
           return event.payload_kg.has_value();
         });
}

/// The daemon's parts, in order of construction.
class Daemon {
 public:
  explicit Daemon(const DaemonOptions& options)
      : options_(options),
        design_(DesignFor(options.config)),
        verdict_(JudgeDesign(options.config, design_)),
        backend_(MakeBackend(options, design_)),
        crash_handler_({.call = HoldLinesOff, .context = backend_.stack.get()}),
        events_(kEventDepth),
        timing_(kTimingDepth),
        latch_(options.config.daemon.state_directory,
               std::filesystem::absolute(options.config.daemon.log_directory).string(),
               [this](bool is_error, const std::string& text) { journal_.Report(is_error, text); }),
        trip_reports_(
            options.trip_page,
            [this](bool is_error, const std::string& text) { journal_.Report(is_error, text); }),
        finisher_(
            [this](bool is_error, const std::string& text) { journal_.Report(is_error, text); },
            &trip_reports_),
        // Absolute: the names in the status and the journal hold in any folder.
        files_(std::filesystem::absolute(options.config.daemon.log_directory),
               options.config.daemon.log, &finisher_,
               [this](bool is_error, const std::string& text) { journal_.Report(is_error, text); }),
        recording_(
            MakeRunInfo(options.config, design_, "monotonic", options.config.backend),
            [this](const RunInfo& info) { return files_.Open(info); },
            [this](bool is_error, const std::string& text) { journal_.Report(is_error, text); }),
        recorder_({.ticks = &stack().tick_records(),
                   .safety = &stack().safety_records(),
                   .timing = &timing_,
                   .events = &events_,
                   .truth = stack().truth_records()},
                  &recording_, &files_),
        executor_(options.realtime),
        telemetry_(MakeTelemetry(options.config)),
        health_(MakeHealthMonitor(options.config, &journal_)),
        judge_(options.config, options.with_law),
        operator_(Context()) {}

  DaemonResult Run();

 private:
  LoopStack& stack() { return *backend_.stack; }
  OperatorContext Context();
  void TakeTick(const TickRecord& tick);
  void ReportDesign();
  void PrepareHost();
  void RestoreTrip();
  void RecoverLogs();
  void AddLoop();
  void Wait(const EndSignals& signals);
  void ReportThreads();

  const DaemonOptions& options_;
  Journal journal_;
  ServiceManager service_;
  Design design_;
  DesignVerdict verdict_;
  Backend backend_;
  CrashHandler crash_handler_;
  EventQueue events_;
  SpscQueue<TimingRecord> timing_;
  TripLatch latch_;
  TripReports trip_reports_;
  RunFinisher finisher_;
  RunFiles files_;
  RunRecording recording_;
  RecorderTask recorder_;
  std::unique_ptr<LockstepTask> behind_clock_;  // the loop, if it runs without real time
  RealtimeExecutor executor_;
  std::unique_ptr<Telemetry> telemetry_;   // null: none is wanted
  std::unique_ptr<HealthMonitor> health_;  // null: it is off
  RunJudge judge_;                         // used by the operator's planner, one run at a time
  OperatorTask operator_;
  TripCause restored_trip_ = TripCause::kNone;  // of the daemon before, still latched at the start
  std::jthread recovery_;  // of the logs that killed daemons left; ends within one log
};

OperatorContext Daemon::Context() {
  OperatorContext context{
      .stack = &stack(),
      .latch = &latch_,
      .events = &events_,
      .files = &files_,
      .design = &design_,
      .config = &options_.config,
      .grid = LoopGrid(options_.config.loop),
      .delay_margin_s = verdict_.delay_margin_s(),
      .limits = MotionLimitsOf(options_.config),
      .reduced_limits = MotionLimitsOf(options_.config, true),
      .arm_checks = {.design = DesignVerdictOf(verdict_),
                     .simulated = stack().simulated(),
                     .check_host =
                         [this] {
                           return HostVerdictOf(CheckHost(options_.config), options_.realtime);
                         }},
      .socket = options_.config.daemon.socket,
      .unattended = options_.experiment,
      .parse_experiment = options_.parse_experiment,
      .judge_experiment =
          [this](const Experiment& experiment, const std::array<double, 2>& start_rad,
                 const std::stop_token& stop) { return judge_.Judge(experiment, start_rad, stop); },
      .report = [this](bool is_error, const std::string& text) { journal_.Report(is_error, text); },
      .identity = DaemonIdentity(options_.config, options_.config_file),
      .thread_status = [this] { return ThreadStatus(executor_); },
      .alive = [this](std::int64_t now_ns, const std::string& s) { service_.Alive(now_ns, s); },
      .newest_trip_report = [this] { return trip_reports_.newest(); }};
  context.take_tick = [this](const TickRecord& tick) { TakeTick(tick); };
  if (telemetry_) context.telemetry_status = [this] { return telemetry_->Status(); };
  if (health_) context.health_status = [this] { return health_->Status(); };
  return context;
}

// Operator thread.
void Daemon::TakeTick(const TickRecord& tick) {
  if (telemetry_) telemetry_->Take(tick);
  if (!health_) return;
  const Permit& permit = stack().operator_permits().Read().Newest().value;
  // The experiment of a run that has ended may be gone.
  const bool runs = permit.state == SafetyState::kRunning;
  health_->Take(tick, runs && ChangesPayload(permit.run.experiment));
}

void Daemon::ReportDesign() {
  for (const DesignCheck& check : verdict_.checks) {
    const std::string waived = check.waived ? " (failed, waived with --force)" : "";
    journal_.Report(!check.passed(), "design: " + CheckText(check) + waived);
  }
  const bool sound = verdict_.result == DesignVerdict::Result::kSound;
  journal_.Report(!sound, std::string("design: ") + ToString(verdict_.result) +
                              (sound ? "" : ": " + verdict_.found));
}

void Daemon::PrepareHost() {
  if (!options_.realtime) {
    journal_.Error(std::string("--without-realtime: ordinary scheduling, unlocked memory. ") +
                   (stack().simulated() ? "The simulated loop runs in lock step, behind the clock."
                                        : "Deadlines will be missed."));
    return;
  }
  for (const std::string& finding : PrepareRealtime(kHighestPriority)) journal_.Info(finding);
}

// Not before the host is prepared: a daemon that may not run leaves no folder.
void Daemon::RestoreTrip() {
  if (const std::optional<HeldTrip> trip = latch_.Open()) {
    stack().StartTripped(trip->cause, trip->evidence);
    restored_trip_ = trip->cause;
  }
}

// Beside the loop: a folder with long logs does not delay the start. The recorder's own runs are
// locked, so the two do not meet.
void Daemon::RecoverLogs() {
  recovery_ = std::jthread([this](const std::stop_token& stop) {
    RecoverRuns(
        options_.config.daemon.log_directory,
        [this](bool is_error, const std::string& text) { journal_.Report(is_error, text); }, stop);
    if (restored_trip_ != TripCause::kNone && !stop.stop_requested()) {
      trip_reports_.Recall(options_.config.daemon.log_directory, ToString(restored_trip_));
    }
  });
}

DaemonResult Daemon::Run() {
  journal_.Info("flexarmd " + ThisBuild().version + " (" + BuildId() + "), rig " +
                options_.config.rig_name + ", backend " + options_.config.backend);
  ReportDesign();
  const EndSignals signals;
  PrepareHost();
  RestoreTrip();
  journal_.Start();
  finisher_.Start();
  RecoverLogs();
  AddLoop();
  executor_.Add(operator_);
  executor_.Add(recorder_);
  const std::int64_t epoch_ns = MonotonicNow() + kEpochLeadNs;
  stack().SetEpoch(epoch_ns);
  executor_.Start(epoch_ns);
  if (telemetry_) telemetry_->Start(epoch_ns);
  if (health_) health_->Start();
  service_.Ready();
  Wait(signals);
  service_.Stopping();
  executor_.RequestStop();
  executor_.Join();
  recorder_.Finish();
  if (health_) health_->Stop();
  finisher_.Stop();
  ReportThreads();
  return {.tripped = operator_.trip() != TripCause::kNone,
          .refused = operator_.refused(),
          .log_errors = recording_.errors() + finisher_.unfinished()};
}

// Without real time, threads wake later than the loop bears: on a busy computer by 200 ms. Where no
// metal moves, the loop need not keep up with the clock.
void Daemon::AddLoop() {
  if (!options_.realtime && stack().simulated()) {
    behind_clock_ = std::make_unique<LockstepTask>(stack().tasks());
    executor_.Add(*behind_clock_);
    return;
  }
  for (Task* task : stack().tasks()) {
    executor_.Add(*task, task == &stack().control() ? &timing_ : nullptr);
  }
}

void Daemon::Wait(const EndSignals& signals) {
  constexpr std::int64_t kLookNs = 50'000'000;
  const std::int64_t end_ns =
      options_.run_for_s ? MonotonicNow() + std::llround(*options_.run_for_s * 1e9) : INT64_MAX;
  while (!operator_.done()) {
    if (signals.Await(kLookNs) || MonotonicNow() >= end_ns) operator_.RequestShutdown();
  }
}

void Daemon::ReportThreads() {
  for (const TaskStatistics& s : Statistics(executor_)) {
    journal_.Report(s.missed_deadlines + s.skipped_periods > 0,
                    std::string(s.name) + ": " + std::to_string(s.activations) + " activations, " +
                        std::to_string(s.missed_deadlines) + " missed deadlines, " +
                        std::to_string(s.skipped_periods) + " skipped periods, worst lateness " +
                        std::to_string(s.worst_lateness_ns / 1'000) + " us, worst run " +
                        std::to_string(s.worst_run_ns / 1'000) + " us");
  }
}

}  // namespace

DaemonResult RunDaemon(const DaemonOptions& options) {
  IgnoreOtherSignals();
  const AlternateStack stack;
  return Daemon(options).Run();
}

}  // namespace flexarm
