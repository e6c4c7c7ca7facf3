#pragma once

#include <array>

#include "estimator/fractional_zero_order_hold.h"
#include "estimator/observer.h"
#include "estimator/state_estimator.h"

namespace flexarm {

/// The observers on the linear nominal model, StateEstimator's `kalman`, `difference` and
/// `polynomial`, with the model's zero-order hold as predictor.
class NominalObserver final : public Observer {
 public:
  NominalObserver(StateEstimator estimator, FractionalZeroOrderHold predictor);

  void Reset() noexcept override { estimator_.Reset(); }
  void Restart() noexcept override { estimator_.Reset(); }
  std::array<double, 4> ModalRates(const PiecewiseTorque& applied) noexcept override {
    return estimator_.ModalRates(applied);
  }
  StateEstimate Update(const Measurement& measurement) noexcept override;
  StateVector Predict(const StateVector& x, const PiecewiseTorque& pending) const noexcept override;

 private:
  StateEstimator estimator_;
  FractionalZeroOrderHold predictor_;
};

}  // namespace flexarm
