#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "controller/health/parallel_plant.h"
#include "controller/health/run_samples.h"

namespace flexarm {

inline constexpr const char* kPayloadChanges = "the payload changes during the run";

/// What one run tells of the rig's health.
struct RunFigures {
  std::vector<DriftFigure> drift;        ///< of DriftChannels, in their order
  std::vector<ResidualFigure> residual;  ///< th1 th2 th3 th4, then the strain channels
  std::size_t samples = 0;               ///< that were used
  /// Mean square of what no drift explains, in units of the expected noise; 1 for a right model.
  double misfit = 0.0;
  std::string unused;  ///< why the figures are not to be judged; empty: they are
};

/// The parallel plant of one run, live or from a log.
///
/// Figures linearises the arm again about the drift that was found, until it stays within the
/// linear range: a stiffness that is 10 % off shifts the vibration of a link by a quarter turn. For
/// that the samples of the run are kept. Not real-time safe.
class RunHealth {
 public:
  /// Samples of a run that are used: 5 minutes at 50 Hz, 9 MB.
  static constexpr std::size_t kMostSamples = 15'000;

  RunHealth(const ControlConfig& config, const NominalPlant& plant);

  /// Records of the loop, from the reset of the run on.
  void Take(const StepInput& input, const StepOutput& output);

  bool ended() const { return samples_.ended(); }
  RunFigures Figures() const;

 private:
  ControlConfig config_;
  NominalPlant plant_;
  RunSamples samples_;
  ParallelPlant parallel_;
  std::vector<HealthSample> kept_;
};

}  // namespace flexarm
