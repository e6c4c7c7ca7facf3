#include "controller/operator/experiment_loader.h"

#include <utility>

namespace flexarm {

void ExperimentLoader::Plan(std::int64_t now_ns, const Experiment& experiment,
                            const std::array<double, 2>& start_rad) {
  if (!stack_->simulated()) RefuseSimEvents(experiment);
  auto planned = std::make_unique<PlannedExperiment>(experiment, *design_, grid_.period_s(),
                                                     start_rad, limits_);
  const Experiment accepted = planned->accepted;
  Load(now_ns, std::move(planned), accepted.name, accepted.text);
}

void ExperimentLoader::Load(std::int64_t now_ns, std::unique_ptr<PlannedExperiment> planned,
                            const std::string& name, const std::string& text) {
  stack_->Plan({.experiment = planned.get(), .number = ++number_});
  loaded_.push_back({.number = number_, .experiment = std::move(planned)});
  name_ = name;
  events_->Push(
      {.time_ns = now_ns, .kind = "experiment", .name = name, .text = text, .value_json = {}});
}

void ExperimentLoader::FreeReleased() {
  while (!loaded_.empty() && loaded_.front().number < stack_->released_experiments()) {
    loaded_.pop_front();
  }
}

}  // namespace flexarm
