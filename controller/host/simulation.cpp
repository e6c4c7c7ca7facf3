#include "controller/host/simulation.h"

#include <chrono>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <utility>

#include "controller/design/run_design.h"
#include "controller/host/ideal_simulation.h"
#include "controller/host/run_info.h"
#include "controller/law/design.h"
#include "controller/operator/operator_task.h"
#include "controller/operator/unattended_run.h"
#include "controller/realtime/lockstep_executor.h"
#include "controller/runlog/durations_of_run.h"
#include "controller/runlog/recorder_task.h"
#include "controller/runlog/run_label.h"
#include "controller/tasks/simulated_stack.h"
#include "controller/types/rejected_error.h"
#include "model/units.h"

namespace flexarm {
namespace {

constexpr std::size_t kQueueDepth = 64;

/// The operator task of a simulated run: one experiment, then the requests of UnattendedRun.
class UnattendedTask final : public Task {
 public:
  UnattendedTask(SimulatedStack* stack, const PlannedExperiment* experiment)
      : stack_(stack), run_(experiment) {}

  Traits traits() const noexcept override {
    return {.name = "operator",
            .period_ns = OperatorTask::kPeriodNs,
            .phase_ns = 0,
            .deadline_ns = OperatorTask::kPeriodNs,
            .priority = 0};
  }

  void Run(const Activation& activation) noexcept override {
    RequestAnswer answer{};
    while (stack_->answers().Pop(&answer)) run_.Answered(answer);
    const Permit& permit = stack_->operator_permits().Read().At(activation.due_ns - 1).value;
    const OperatorRequest request = run_.Update(activation.due_ns, permit);
    if (request.kind != RequestKind::kNone) stack_->requests().Push(request);
  }

  const UnattendedRun& run() const { return run_; }

 private:
  SimulatedStack* stack_;
  UnattendedRun run_;
};

/// Keeps every tick in memory for the metrics, and writes all records to the log.
class MemoryAndLog final : public RunMemory {
 public:
  MemoryAndLog(RunContents* contents, std::unique_ptr<RunSink> log)
      : RunMemory(contents), log_(std::move(log)) {}

  std::string Name() const override { return log_->Name(); }
  void Tick(const TickRecord& record) override {
    RunMemory::Tick(record);
    log_->Tick(record);
  }
  void Timing(const TimingRecord& record) override { log_->Timing(record); }
  void Safety(const SafetyRecord& record) override {
    RunMemory::Safety(record);
    log_->Safety(record);
  }
  void Event(const RunEvent& event) override { log_->Event(event); }
  void Commit() override { log_->Commit(); }
  std::string Trouble() const override { return log_->Trouble(); }
  void Close(const std::string& result_json) override { log_->Close(result_json); }

 private:
  std::unique_ptr<RunSink> log_;
};

OpenSink SinkFor(const SimulationRequest& request, RunContents* contents) {
  if (!request.log) return RunInMemory(contents);
  return
      [contents, open = RunInFile(*request.log)](const RunInfo& info) -> std::unique_ptr<RunSink> {
        return std::make_unique<MemoryAndLog>(contents, open(info));
      };
}

RunInfo InfoOf(const SimulationRequest& request, const Design& design, double payload_kg) {
  RunInfo info = MakeRunInfo(request.config, design, "simulated", "sim");
  info.payload_kg = payload_kg;
  return info;
}

std::optional<SimulatedTrip> TripFound(const std::vector<SafetyRecord>& records,
                                       const LoopGrid& grid) {
  std::int64_t start_ns = 0;
  for (const SafetyRecord& record : records) {
    const bool begins =
        record.after.state == SafetyState::kRunning && record.before.state != SafetyState::kRunning;
    if (begins) start_ns = grid.ExperimentStart(record.due_ns);
    if (record.after.cause == TripCause::kNone || record.before.cause != TripCause::kNone) continue;
    return SimulatedTrip{.cause = record.after.cause,
                         .evidence = record.evidence,
                         .at_s = static_cast<double>(record.due_ns - start_ns) * 1e-9};
  }
  return std::nullopt;
}

/// The parts of a simulated run, in order of construction.
PlannedExperiment PlanOf(const SimulationRequest& request, const Design& design) {
  try {
    return {request.experiment, design, request.config.loop.period_s(), request.start_rad,
            MotionLimitsOf(request.config, request.config.safety.reduced)};
  } catch (const RejectedError& error) {
    if (request.experiment_file.empty()) throw;
    throw RejectedError(request.experiment_file.string() + ": " + error.what());
  }
}

SimulationResult ResultOf(const RigConfig& config, const PlannedExperiment& planned,
                          const RunContents& contents, TripCause trip) {
  SimulationResult result;
  result.metrics = ComputeMetrics(contents.tick, planned.accepted, config.loop.period_s(),
                                  TipGeometryOf(config));
  result.ticks = result.metrics.ticks;
  result.trip = trip;
  result.completed = trip == TripCause::kNone && result.ticks == planned.reference.periods();
  const Experiment of_run =
      WithDurationsOfRun(planned.accepted, contents.tick, config.loop.period_s());
  for (const Move& move : of_run.move) {
    result.move_duration_s.push_back(move.duration_s.value());
  }
  return result;
}

SimulationResult SimulateIdeal(const SimulationRequest& request) {
  using Clock = std::chrono::steady_clock;
  const Design design = DesignFor(request.config);
  const PlannedExperiment planned = PlanOf(request, design);
  const RigConfig& plant = request.plant ? *request.plant : request.config;
  const auto started = Clock::now();
  RunContents contents;
  const TripCause trip = RunIdeal(
      request, design, planned, request.payload_kg.value_or(plant.arm.payload_mass_kg), &contents);
  const double wall_s = std::chrono::duration<double>(Clock::now() - started).count();
  SimulationResult result = ResultOf(request.config, planned, contents, trip);
  result.realtime_factor =
      static_cast<double>(result.ticks) * request.config.loop.period_s() / wall_s;
  return result;
}

class Simulation {
 public:
  explicit Simulation(const SimulationRequest& request);

  SimulationResult Run(const std::function<void(double)>& progress);

 private:
  void Announce();
  /// Runs the tasks until the operator is done. @returns wall-clock time, s
  double Loop(const std::function<void(double)>& progress);
  SimulationResult Result(double wall_s) const;

  const RigConfig& Plant() const { return request_.plant ? *request_.plant : request_.config; }

  const SimulationRequest& request_;
  LoopGrid grid_;
  Design design_;
  double payload_kg_;
  PlannedExperiment planned_;
  SimulatedStack stack_;
  RunContents contents_;
  std::string log_error_;
  RunRecording recording_;
  EventQueue events_;
  SpscQueue<TimingRecord> timing_;  // a simulated clock has no wall-clock figures
  RecorderTask recorder_;
  UnattendedTask operator_;
  std::int64_t simulated_ns_ = 0;
};

Simulation::Simulation(const SimulationRequest& request)
    : request_(request),
      grid_(request.config.loop),
      design_(DesignFor(request.config)),
      payload_kg_(request.payload_kg.value_or(Plant().arm.payload_mass_kg)),
      planned_(PlanOf(request, design_)),
      stack_(request.config, Plant(), design_, payload_kg_, request.start_rad),
      recording_(InfoOf(request, design_, payload_kg_), SinkFor(request, &contents_),
                 [this](bool is_error, const std::string& text) {
                   if (is_error && log_error_.empty()) log_error_ = text;
                 }),
      events_(kQueueDepth),
      timing_(kQueueDepth),
      recorder_({.ticks = &stack_.tick_records(),
                 .safety = &stack_.safety_records(),
                 .timing = &timing_,
                 .events = &events_,
                 .truth = stack_.truth_records()},
                &recording_),
      operator_(&stack_, &planned_) {
  stack_.Calibrate(CalibrationOf(request));
}

void Simulation::Announce() {
  events_.Push({.time_ns = 0,
                .kind = "experiment",
                .name = planned_.accepted.name,
                .text = planned_.accepted.text,
                .value_json = Announcement(0, request_.label)});
  events_.Push({.time_ns = 0,
                .kind = "simulation",
                .name = "payload",
                .text = {},
                .value_json = "{\"payload_kg\": " + std::to_string(payload_kg_) + "}"});
}

double Simulation::Loop(const std::function<void(double)>& progress) {
  constexpr std::int64_t kProgressNs = 100'000'000;
  LockstepExecutor executor;
  for (Task* task : stack_.tasks()) executor.Add(*task);
  executor.Add(operator_);
  executor.Add(recorder_);
  const auto started = std::chrono::steady_clock::now();
  executor.RunWhile([&](std::int64_t now_ns) {
    if (progress && now_ns / kProgressNs != simulated_ns_ / kProgressNs) {
      progress(static_cast<double>(now_ns) * 1e-9);
    }
    simulated_ns_ = now_ns;
    return now_ns < operator_.run().over_ns();
  });
  recorder_.Finish();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
}

SimulationResult Simulation::Result(double wall_s) const {
  SimulationResult result = ResultOf(request_.config, planned_, contents_, operator_.run().trip());
  result.trip_found = TripFound(contents_.safety, grid_);
  for (const TickRecord& record : contents_.tick) {
    const auto samples = int{record.output.delay_found};
    if (samples != 0) result.delay_found = samples;
  }
  result.realtime_factor = static_cast<double>(simulated_ns_) * 1e-9 / wall_s;
  return result;
}

SimulationResult Simulation::Run(const std::function<void(double)>& progress) {
  Announce();
  const double wall_s = Loop(progress);
  if (!log_error_.empty()) throw std::runtime_error(log_error_);
  if (operator_.run().progress() == UnattendedRun::Progress::kRefused) {
    throw std::runtime_error("the simulated run was refused by the safety machine");
  }
  return Result(wall_s);
}

}  // namespace

Calibration CalibrationOf(const SimulationRequest& request) {
  Calibration calibration = request.calibration;
  calibration.counter_zero = {};
  for (const EncoderConfig& encoder : request.config.sensors.encoder) {
    const auto counter = static_cast<std::size_t>(encoder.counter);
    const double angle_rad = request.start_rad[counter % 2];  // a rotor is where its hub is
    calibration.counter_zero[counter] =
        -std::llround(angle_rad * encoder.sign * encoder.counts_per_turn / kTwoPi);
  }
  return calibration;
}

SimulationResult Simulate(const SimulationRequest& request,
                          const std::function<void(double)>& progress) {
  if (request.log && std::filesystem::exists(*request.log)) {
    throw RejectedError(request.log->string() + ": exists already; a run is never overwritten");
  }
  if (request.config.estimator.kind == EstimatorKind::kIdeal) return SimulateIdeal(request);
  return Simulation(request).Run(progress);
}

}  // namespace flexarm
