#pragma once

#include "estimator/observer.h"

namespace flexarm {

/// The observer `ideal`: the state is the one that it was told, and acts at once, so there is
/// nothing to predict. For simulations with known state; no arm can tell it.
/// Real-time: safe.
class IdealObserver final : public Observer {
 public:
  explicit IdealObserver(int states) : x_(StateVector::Zero(states)) {}

  /// The state at the sample of the next Update. Keeps its value until told another.
  void Know(const StateVector& x) noexcept { x_ = x; }

  void Reset() noexcept override {}
  void Restart() noexcept override {}
  std::array<double, 4> ModalRates(const PiecewiseTorque& /*applied*/) noexcept override {
    return {};
  }
  StateEstimate Update(const Measurement& /*measurement*/) noexcept override {
    return {.x = x_, .innovation = {}};
  }
  StateVector Predict(const StateVector& x,
                      const PiecewiseTorque& /*pending*/) const noexcept override {
    return x;
  }

 private:
  StateVector x_;
};

}  // namespace flexarm
