#include "estimator/nominal_observer.h"

#include <utility>

namespace flexarm {

NominalObserver::NominalObserver(StateEstimator estimator, FractionalZeroOrderHold predictor)
    : estimator_(std::move(estimator)), predictor_(std::move(predictor)) {}

StateEstimate NominalObserver::Update(const Measurement& measurement) noexcept {
  return estimator_.Update(*measurement.counters, *measurement.modes, *measurement.applied);
}

StateVector NominalObserver::Predict(const StateVector& x,
                                     const PiecewiseTorque& pending) const noexcept {
  StateVector next = x;
  predictor_.Advance(pending, &next);
  return next;
}

}  // namespace flexarm
