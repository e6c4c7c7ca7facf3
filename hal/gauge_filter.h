#pragma once

#include <Eigen/Core>

#include "hal/sensor_config.h"
#include "hal/sensor_frame.h"

namespace flexarm {

/// The analogue low-pass between gauge and converter, of first or second order, discretised.
///
/// Exact for an input that is constant over a step; uses the mean of the input's ends, so that a
/// linear input is followed to second order in the step. Without a filter the output is the input.
/// Starts at rest at zero. Real-time: all but the constructor are safe.
class GaugeFilter {
 public:
  /// Signals filtered in parallel; no heap.
  using Signals = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxStrainChannels, 1>;

  /// @param size  number of signals, at most kMaxStrainChannels
  GaugeFilter(const StrainInputConfig& input, double step_s, Eigen::Index size);

  /// Sets the steady state for this input.
  void Settle(const Signals& input) noexcept;
  /// One step; `input` is the input at its end.
  void Step(const Signals& input) noexcept;
  const Signals& output() const noexcept { return output_; }

 private:
  enum class Order { kNone, kFirst, kSecond };

  Order order_;
  double blend_ = 1.0;     // first order: 1 - exp(-w h)
  Eigen::Matrix2d decay_;  // second order: of (output - input, its rate) over a step
  Signals before_, output_, rate_;
};

}  // namespace flexarm
