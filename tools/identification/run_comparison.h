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

/// Compares a measured run with the prediction of the nonlinear model under the same torques.
///
/// Signals: the angle of every encoder, and of every link the tip deflection measured by its gauges
/// (least squares over the modes of the config). The model gets only the torques and the joint
/// angles at the start, where it is at rest: the prediction is not corrected during the run.
/// Thread: Predict may run on several at a time.
class RunComparison {
 public:
  /// @param file    a run log, which contains its calibration, or a CSV file (*.csv)
  /// @param config  of the rig before the identification: it converts the gauges' counts into
  /// deflections, for measured and predicted signals alike
  /// @param span    part of the run to use; the arm should be at rest at its beginning
  /// @throws InputError, ConfigError
  RunComparison(std::filesystem::path file, const RigConfig& config, TimeSpan span = {});

  const std::filesystem::path& file() const { return file_; }
  const std::vector<ComparedSignal>& signal() const { return signal_; }
  const Eigen::VectorXd& time_s() const { return time_s_; }      ///< from the start of the run
  const Eigen::MatrixXd& measured() const { return measured_; }  ///< samples x signals
  const Eigen::MatrixXd& compared() const { return compared_; }  ///< 1: compared, 0: left out
  /// Standard deviation of each signal over the compared samples, positive.
  const Eigen::VectorXd& spread() const { return spread_; }

  /// samples x signals; not finite if the simulated arm diverges.
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
  std::vector<Eigen::Index> counter_;  // counters of the signals that are angles
  Eigen::MatrixXd tip_of_counts_;      // 2 x channels: tip deflection of the config's gauges
  Eigen::VectorXd count_offset_;
  Eigen::Index first_ = 0;  // input of the first row
  Eigen::VectorXd time_s_, spread_;
  Eigen::MatrixXd measured_, compared_;
};

/// 100 (1 - |y - yhat| / |y - mean y|) over the compared samples, per signal. 100: equal; 0: no
/// better than the mean; can be negative.
Eigen::VectorXd FitPercent(const RunComparison& run, const Eigen::MatrixXd& predicted);

}  // namespace flexarm
