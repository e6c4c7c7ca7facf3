#include "controller/health/run_health.h"

#include <cmath>

#include "controller/health/drift_scale.h"

namespace flexarm {
namespace {

constexpr int kMostPasses = 5;
constexpr double kSure = 3.0;  // standard errors: a smaller drift is not followed

constexpr const char* kNoDriftExplains =
    "no drift explains the run: the arm is not that of the config";

// What a run tells in which the parallel plant is of no use.
void Forget(const ControlConfig& config, RunFigures* figures) {
  const std::vector<DriftChannel> channels = DriftChannels(config.arm, config.sensors);
  for (std::size_t i = 0; i < channels.size(); ++i) {
    figures->drift[i] = {.value = 0.0,
                         .standard_error = ScaleOf(channels[i], config.arm, config.sensors).prior};
  }
  figures->misfit = 0.0;
  figures->unused = kNoDriftExplains;
}

// Adds to `total` the drift of the pass. Returns whether it leads out of the linear range.
bool Follow(const ControlConfig& config, const std::vector<DriftFigure>& found,
            std::vector<double>* total) {
  const std::vector<DriftChannel> channels = DriftChannels(config.arm, config.sensors);
  bool beyond = false;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const DriftScale scale = ScaleOf(channels[i], config.arm, config.sensors);
    const double drift = found[i].value;
    if (scale.linear <= 0.0) continue;
    beyond = beyond || (std::fabs(drift) > scale.linear &&
                        std::fabs(drift) > kSure * found[i].standard_error);
  }
  if (!beyond) return false;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const DriftScale scale = ScaleOf(channels[i], config.arm, config.sensors);
    if (scale.linear <= 0.0 || std::fabs(found[i].value) < kSure * found[i].standard_error)
      continue;
    (*total)[i] += found[i].value;
  }
  return true;
}

}  // namespace

RunHealth::RunHealth(const ControlConfig& config, const NominalPlant& plant)
    : config_(config), plant_(plant), samples_(config), parallel_(config, plant) {}

void RunHealth::Take(const StepInput& input, const StepOutput& output) {
  const std::optional<HealthSample> sample = samples_.Take(input, output);
  if (!sample || kept_.size() == kMostSamples) return;
  kept_.push_back(*sample);
  parallel_.Take(*sample);
}

RunFigures RunHealth::Figures() const {
  RunFigures figures{.drift = parallel_.Drift(),
                     .residual = parallel_.Residuals(),
                     .samples = kept_.size(),
                     .misfit = parallel_.Misfit(),
                     .unused = {}};
  NominalPlant plant = plant_;
  plant.drift.assign(figures.drift.size(), 0.0);
  const std::vector<DriftChannel> channels = DriftChannels(config_.arm, config_.sensors);
  for (int pass = 1; pass < kMostPasses && Follow(config_, figures.drift, &plant.drift); ++pass) {
    if (!IsPossible(channels, plant.drift)) break;
    ParallelPlant again(config_, plant);
    for (const HealthSample& sample : kept_) again.Take(sample);
    figures.drift = again.Drift();
    figures.misfit = again.Misfit();
  }
  std::vector<double> total;
  for (std::size_t i = 0; i < figures.drift.size(); ++i) {
    figures.drift[i].value += plant.drift[i];
    total.push_back(figures.drift[i].value);
  }
  if (!IsPossible(channels, total) || !std::isfinite(figures.misfit)) Forget(config_, &figures);
  if (samples_.gaps()) figures.unused = "samples of the run are missing";
  if (samples_.load_changes()) figures.unused = kPayloadChanges;
  return figures;
}

}  // namespace flexarm
