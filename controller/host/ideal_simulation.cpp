#include "controller/host/ideal_simulation.h"

#include <bit>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "controller/host/run_info.h"
#include "controller/realtime/float_environment.h"
#include "controller/runlog/run_writer.h"
#include "controller/step/control_step.h"
#include "controller/tasks/follow_reference.h"
#include "controller/types/rejected_error.h"
#include "controller/types/trip_cause.h"
#include "estimator/ideal_observer.h"
#include "hal/sim/simulated_rig.h"

namespace flexarm {
namespace {

ArmParameters ArmWith(ArmParameters arm, double payload_kg) {
  arm.payload_mass_kg = payload_kg;
  return arm;
}

// The nominal model's coordinates of the plant's; modes that the plant lacks are zero.
void Pick(const ArmVector& full, const StateLayout& layout, int plant_modes, StateVector* x,
          int at) {
  for (int i = 0; i < layout.angles(); ++i) (*x)(at + i) = full(i);
  for (int link = 0; link < 2; ++link) {
    for (int mode = 0; mode < layout.modes_per_link && mode < plant_modes; ++mode) {
      (*x)(at + layout.mode(link, mode)) = full(kPhi1 + link * plant_modes + mode);
    }
  }
}

class IdealLoop {
 public:
  IdealLoop(const SimulationRequest& request, const Design& design, double payload_kg);

  /// One period. @returns the faults of the step
  TripCauses Advance(std::int64_t tick, const TimedReference& reference, RunSink* sink);

 private:
  StateVector TrueState() const;
  StepInput Input(std::int64_t tick, const TimedReference& reference);

  StateLayout layout_;
  int plant_modes_;
  std::int64_t period_ns_;
  SimulatedRig rig_;
  Calibration calibration_;
  IdealObserver* observer_;  // owned by step_
  ControlStep step_;
  std::array<double, 2> torque_nm_{};
};

IdealLoop::IdealLoop(const SimulationRequest& request, const Design& design, double payload_kg)
    : layout_(design.layout),
      plant_modes_((request.plant ? *request.plant : request.config).sim.plant_modes),
      period_ns_(request.config.loop.period_ns()),
      rig_(ArmWith((request.plant ? *request.plant : request.config).arm, payload_kg),
           request.config.sensors, (request.plant ? *request.plant : request.config).sim,
           request.start_rad),
      calibration_(CalibrationOf(request)),
      observer_(new IdealObserver(layout_.states())),
      step_(request.config, design, std::unique_ptr<Observer>(observer_)) {}

StateVector IdealLoop::TrueState() const {
  StateVector x = StateVector::Zero(layout_.states());
  Pick(rig_.state().q, layout_, plant_modes_, &x, 0);
  Pick(rig_.state().v, layout_, plant_modes_, &x, layout_.dof());
  return x;
}

StepInput IdealLoop::Input(std::int64_t tick, const TimedReference& reference) {
  StepInput input{};
  const std::int64_t now_ns = tick * period_ns_;
  input.tick = tick;
  input.now_ns = input.sampling_instant_ns = now_ns;
  input.frame = rig_.Sample(now_ns);
  input.calibration = calibration_;
  input.applied_torque_nm = torque_nm_;
  input.acted_late_ns = input.acts_late_ns = -period_ns_;  // at k Ts, not at (k+1) Ts
  const int k = static_cast<int>(tick);
  input.reference_now = input.reference_next = reference.At(k);
  input.path = reference.PathAround(k);
  input.same_load = reference.KeepsLoad(k) ? 1 : 0;
  input.load_changes = reference.LoadChanges(k) ? 1 : 0;
  input.safety_state = SafetyState::kRunning;
  input.reset = tick == 0 ? 1 : 0;
  input.reference_ended = k >= reference.periods() - 1 ? 1 : 0;
  return input;
}

TripCauses IdealLoop::Advance(std::int64_t tick, const TimedReference& reference, RunSink* sink) {
  TickRecord record{};
  record.input = Input(tick, reference);
  observer_->Know(TrueState());
  record.output = step_.Step(record.input);
  record.run_number = 1;
  record.truth = rig_.truth();
  sink->Tick(record);
  torque_nm_ = record.output.torque_nm;
  rig_.SetTorque(torque_nm_);
  for (std::int64_t t = 0; t < period_ns_; t += rig_.step_ns()) rig_.Step();
  return record.output.faults;
}

std::unique_ptr<RunSink> SinkOf(const SimulationRequest& request, const Design& design) {
  RunInfo info = MakeRunInfo(request.config, design, "simulated", "sim");
  info.experiment_name = request.experiment.name;
  info.experiment_text = request.experiment.text;
  info.label = request.label;
  if (request.payload_kg) info.payload_kg = request.payload_kg;
  return std::make_unique<RunWriter>(*request.log, info);
}

std::string ResultJson(TripCause trip, std::int64_t ticks) {
  const bool tripped = trip != TripCause::kNone;
  const nlohmann::json result = {
      {"completed", !tripped},
      {"trip", tripped ? nlohmann::json(ToString(trip)) : nlohmann::json(nullptr)},
      {"ticks", ticks}};
  return result.dump();
}

/// Keeps the ticks for the metrics, and passes them on.
class Kept final : public RunMemory {
 public:
  Kept(RunContents* contents, RunSink* next) : RunMemory(contents), next_(next) {}
  void Tick(const TickRecord& record) override {
    RunMemory::Tick(record);
    if (next_ != nullptr) next_->Tick(record);
  }

 private:
  RunSink* next_;
};

}  // namespace

TripCause RunIdeal(const SimulationRequest& request, const Design& design,
                   const PlannedExperiment& planned, double payload_kg, RunContents* contents) {
  if (!request.experiment.sim_event.empty()) {
    throw RejectedError("sim_event[1]: a simulation with estimator.name = \"ideal\" has none");
  }
  IdealLoop loop(request, design, payload_kg);
  const std::unique_ptr<RunSink> log = request.log ? SinkOf(request, design) : nullptr;
  Kept sink(contents, log.get());
  const FlushDenormals as_in_the_tasks;
  TripCauses faults = 0;
  std::int64_t tick = 0;
  TimedReference reference;
  reference.Start(&planned.reference, &planned.load_change);
  for (; tick < planned.reference.periods() && faults == 0; ++tick) {
    reference.Choose(static_cast<int>(tick), kNoPayloadEstimate);
    faults = loop.Advance(tick, reference, &sink);
  }
  const auto trip =
      faults == 0 ? TripCause::kNone : static_cast<TripCause>(std::countr_zero(faults));
  if (log) log->Close(ResultJson(trip, tick));
  return trip;
}

}  // namespace flexarm
