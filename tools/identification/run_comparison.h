#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "config/config.h"
#include "controller/types/csv_import_config.h"
#include "controller/types/step_types.h"
#include "model/simulation/arm_simulator.h"

namespace flexarm {

/// One signal that the rig measures and the model predicts.
struct ComparedSignal {
  std::string name;  ///< "joint1", "joint2", "rotor1", "rotor2", "link1", "link2"
  bool angle;        ///< rad; else the tip's deflection against the link's root, m
};

/// Part of a run, in seconds since its first sample, both ends included.
struct TimeSpan {
  double from_s = 0.0;
  double until_s = std::numeric_limits<double>::infinity();
};

/// A measured run beside what the nonlinear model makes of the torques that were applied in it.
///
/// Signals: the angle of every encoder, and of every link the tip deflection that its gauges tell
/// (least squares over the modes of the config). The model is only told the torques and the joint
/// angles at the start, where it is at rest: nothing is corrected on the way.
/// Thread: Predict may run on several at a time.
class RunComparison {
 public:
  /// @param file    a run log, which brings its own calibration, or a CSV file (*.csv)
  /// @param config  of the rig, as it was before anything was identified: the gauges' counts are
  ///                turned into deflections by it, measured and predicted ones alike
  /// @param span    what of the run is used; the arm should be at rest where it begins
  /// @throws InputError, ConfigError
  RunComparison(std::filesystem::path file, const RigConfig& config, TimeSpan span = {});

  const std::filesystem::path& file() const { return file_; }
  const std::vector<ComparedSignal>& signal() const { return signal_; }
  const Eigen::VectorXd& time_s() const { return time_s_; }      ///< from the start of the run
  const Eigen::MatrixXd& measured() const { return measured_; }  ///< samples x signals
  const Eigen::MatrixXd& compared() const { return compared_; }  ///< 1, or 0: left out
  /// Standard deviation of each signal over what is compared, positive.
  const Eigen::VectorXd& spread() const { return spread_; }

  /// samples x signals; not finite if the simulated arm does not survive it.
  /// @throws ConfigError
  Eigen::MatrixXd Predict(const RigConfig& candidate) const;

 private:
  void Measure(const RigConfig& config);
  void KeepSpan();
  void FormSpread();
  ArmState Start(int dof) const;
  std::vector<StepInput> Inputs(const RigConfig& config) const;

  std::filesystem::path file_;
  TimeSpan span_;
  bool csv_;
  std::optional<CsvImport> csv_import_;
  std::vector<StepInput> input_;
  std::vector<ComparedSignal> signal_;
  std::vector<Eigen::Index> counter_;  // of the signals that are angles
  Eigen::MatrixXd tip_of_counts_;      // 2 x channels: tip deflection of the config's gauges
  Eigen::VectorXd count_offset_;
  Eigen::Index first_ = 0;  // input of the first row
  Eigen::VectorXd time_s_, spread_;
  Eigen::MatrixXd measured_, compared_;
};

/// 100 (1 - |y - yhat| / |y - mean y|) over what is compared, per signal. 100: the same; 0: no
/// better than the mean; can be negative.
Eigen::VectorXd FitPercent(const RunComparison& run, const Eigen::MatrixXd& predicted);

}  // namespace flexarm
