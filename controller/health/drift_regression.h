#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace flexarm {

/// What a run tells of a parameter.
struct DriftFigure {
  double value;           ///< relative to the nominal plant
  double standard_error;  ///< one sigma; that of the prior if the run does not tell

  friend bool operator==(const DriftFigure&, const DriftFigure&) = default;
};

/// Least squares of all parameters together, from the residuals of the parallel plant:
///
///   W^(1/2) residual = W^(1/2) (d prediction / d parameter) parameter + noise
///
/// Every parameter has a prior about zero, so that one that a run does not excite keeps the prior's
/// standard error and leaves the others alone. The common gain of a family of gauges is that of
/// their link's stiffness, upside down: the mean of the middle half of each family is therefore
/// held at zero, so that a single gauge's drift is its own. Standard errors come from the scatter
/// of the scores of blocks of samples (a cluster-robust covariance), since residuals are correlated
/// within a motion; never less than white noise gives. Memory is bounded: a long run has longer
/// blocks. Not real-time safe.
class DriftRegression {
 public:
  struct Settings {
    std::vector<double> prior;                     ///< sigma of each parameter
    std::vector<std::vector<std::size_t>> family;  ///< parameters: the gains of a link's gauges
    int block_samples;                             ///< at first
  };

  explicit DriftRegression(Settings settings);

  /// Some rows of a sample, already weighted.
  /// @param sensitivity  rows x parameters
  void Add(const Eigen::MatrixXd& sensitivity, const Eigen::VectorXd& residual);
  void EndSample();

  std::vector<DriftFigure> Solve() const;
  /// Mean square of the weighted residuals that the solution leaves.
  double Misfit() const;

 private:
  struct Block {
    Eigen::MatrixXd information;  // lower half
    Eigen::VectorXd score;
    int samples = 0;
  };

  static constexpr std::size_t kMostBlocks = 64;

  Block EmptyBlock() const;
  void MergePairs();
  Eigen::MatrixXd Held(Eigen::MatrixXd information, const std::vector<std::size_t>& held) const;

  Settings settings_;
  struct Solution {
    Eigen::LLT<Eigen::MatrixXd> normal;
    Eigen::VectorXd x;  // in units of the prior
    double explained;   // square sum
  };
  Solution Minimise() const;

  Eigen::VectorXd prior_;
  double squares_ = 0.0;  // of the weighted residuals
  double rows_ = 0.0;
  std::vector<Block> block_;  // the last one grows
};

}  // namespace flexarm
