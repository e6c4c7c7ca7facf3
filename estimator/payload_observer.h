#pragma once

#include <array>

#include "estimator/observer.h"
#include "estimator/payload_estimator.h"
#include "estimator/payload_monitor.h"

namespace flexarm {

/// The observer `ekf-payload`: the extended Kalman filter of PayloadEstimator with its monitor, and
/// its model as predictor.
///
/// If the innovations contradict the filter's model, the payload is assumed to be lost
/// (docs/theory/payload.md 2.6).
class PayloadObserver final : public Observer {
 public:
  PayloadObserver(PayloadEstimator estimator, const PayloadEstimatorConfig& config);

  void Reset() noexcept override;
  void Restart() noexcept override { estimator_.Reset(); }
  std::array<double, 4> ModalRates(const PiecewiseTorque& applied) noexcept override;
  void FollowPath(const PathMotion& motion) noexcept override;
  StateEstimate Update(const Measurement& measurement) noexcept override;
  StateVector Predict(const StateVector& x, const PiecewiseTorque& pending) const noexcept override;
  bool wants_torque_by_delay() const noexcept override { return detect_delay_; }
  int delay_found() const noexcept override { return estimator_.delay_found(); }
  PayloadKnowledge payload() const noexcept override { return known_; }

 private:
  PayloadEstimator estimator_;
  PayloadMonitor monitor_;
  bool detect_delay_;
  bool moves_ = false;
  PayloadKnowledge known_ = kNoPayloadEstimate;
};

}  // namespace flexarm
