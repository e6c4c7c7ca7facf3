#include "tools/replay/log_replay.h"

#include <memory>
#include <stdexcept>

#include "controller/design/design_json.h"
#include "controller/runlog/errors.h"
#include "controller/step/control_step.h"
#include "estimator/ideal_observer.h"

namespace flexarm {
namespace {

/// ControlStep with the observer `ideal`, which is told the state that each record has.
class IdealReplay {
 public:
  IdealReplay(const RigConfig& config, const Design& design)
      : states_(design.layout.states()),
        observer_(new IdealObserver(states_)),
        step_(config, design, std::unique_ptr<Observer>(observer_)) {}

  void Know(const StepOutput& recorded) {
    StateVector x(states_);
    for (int i = 0; i < states_; ++i) x(i) = recorded.x_hat[static_cast<std::size_t>(i)];
    observer_->Know(x);
  }
  StepOutput Step(const StepInput& input) { return step_.Step(input); }

 private:
  int states_;
  IdealObserver* observer_;  // owned by step_
  ControlStep step_;
};

StepFunction Fresh(const RigConfig& config, const Design& design) {
  const auto step = std::make_shared<ControlStep>(config, design);
  return [step](const StepInput& input) { return step->Step(input); };
}

}  // namespace

Design GainsOf(const RunReader& reader, const RigConfig& config) {
  try {
    return DesignFromJson(reader.info().gains_json, config);
  } catch (const std::runtime_error& error) {
    throw InputError(reader.file().string() +
                     ": the gains in this log cannot be used: " + error.what());
  }
}

ReplayResult ReplayLog(RunReader* reader, const RigConfig& config, const Design& design,
                       bool other_config) {
  const bool is_ideal = config.estimator.kind == EstimatorKind::kIdeal;
  const auto ideal = is_ideal ? std::make_shared<IdealReplay>(config, design) : nullptr;
  Replay replay(ideal ? [ideal](const StepInput& input) { return ideal->Step(input); }
                      : Fresh(config, design),
                other_config);
  reader->ForEachTick([&](const TickRecord& record) {
    if (ideal) ideal->Know(record.output);
    replay.Tick(record);
  });
  reader->ForEachSafety([&](const SafetyRecord& record) { replay.Safety(record); });
  return replay.Result();
}

}  // namespace flexarm
