#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace flexarm {

/// The Kalman filter's covariance in and after samples that lack outputs.
///
/// The steady gain is that of all outputs in every sample. Without some of them, or after such a
/// sample, it is another filter's gain: with every second sample lost, predicting and correcting
/// with it diverges (docs/theory/control-law.md 7.3). From an incomplete sample on, until the
/// covariance is steady again, the gain of each sample follows from the covariance of exactly the
/// readings that there were:
///   P <- P - P c'(c P c' + r)^-1 c P for each output that is there,  then  P <- A P A' + W.
/// W is left out after an incomplete sample: it is tuned for a steady gain that bears a model with
/// a wrong payload, and the larger gain that it would give the next sample excites the bent arm
/// (docs/theory/control-law.md 7.3).
/// Real-time: all but the constructor is safe.
class FilterCovariance {
 public:
  using State = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 24, 1>;
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 24, 24>;
  using Outputs = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 8, 1>;

  /// Complete samples in a row after which the covariance counts as steady again. The error of the
  /// slowest shipped filter falls by 0.86 a sample, its covariance by the square of that: to 1e-8.
  static constexpr int kSettledSamples = 64;

  /// @param A, C    n x n and outputs x n, of the filter
  /// @param W, R    covariance of the process noise of a period; variances of the outputs
  /// @param steady  covariance of the steady filter's prediction
  FilterCovariance(const Eigen::MatrixXd& A, const Eigen::MatrixXd& C, const Eigen::MatrixXd& W,
                   const Eigen::VectorXd& R, const Eigen::MatrixXd& steady);

  /// Steady again.
  void Reset() noexcept { settled_ = kSettledSamples; }
  bool steady() const noexcept { return settled_ == kSettledSamples; }

  /// Corrects the predicted state x by the outputs `good` of y, one after the other, which equals
  /// all at once. Every sample from the first incomplete one until steady().
  /// @param complete  no output is missing
  void Correct(const Outputs& y, std::uint32_t good, bool complete, State* x) noexcept;

  /// An output: its row of C, without the entries that are zero, and its variance.
  struct Output {
    struct Entry {
      std::size_t state;
      double factor;  ///< unit of the output per unit of the state
    };
    std::vector<Entry> row;
    double variance;  ///< in the square of the unit of the output
  };

 private:
  void CorrectPadded(const Outputs& y, std::uint32_t good, bool complete, State* x) noexcept;
  template <int kRows>
  void CorrectRows(const Outputs& y, std::uint32_t good, bool complete, State* x) noexcept;

  // With rows and columns of zeros up to a multiple of four, so that loops take four at a time.
  Square A_, A_transposed_, W_, steady_;
  std::vector<Output> outputs_;
  Square P_;  // of the prediction, unless steady()
  int settled_ = kSettledSamples;
};

}  // namespace flexarm
