#include "estimator/payload_observer.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace flexarm {
namespace {

// The vibration that a move excites makes the payload observable; it decays within this time.
constexpr double kVibrationDecays_s = 2.0;

}  // namespace

PayloadObserver::PayloadObserver(PayloadEstimator estimator, const PayloadEstimatorConfig& config)
    : estimator_(std::move(estimator)), monitor_(config), detect_delay_(config.detect_delay) {}

void PayloadObserver::Reset() noexcept {
  estimator_.Reset();
  monitor_.Reset();
  moves_ = false;
}

std::array<double, 4> PayloadObserver::ModalRates(const PiecewiseTorque& /*applied*/) noexcept {
  return estimator_.ModalRates();
}

void PayloadObserver::FollowPath(const PathMotion& motion) noexcept {
  moves_ = motion.moves;
  if (motion.begins) estimator_.BeginMove(motion.same_load);
  if (motion.load_changes) estimator_.PayloadMayChange();
  if (std::isfinite(motion.rested_s) && motion.rested_s > kVibrationDecays_s) estimator_.EndMove();
}

StateEstimate PayloadObserver::Update(const Measurement& measurement) noexcept {
  const PayloadFilter::Estimate& found =
      measurement.applied_by_delay != nullptr
          ? estimator_.Update(*measurement.counters, *measurement.modes,
                              *measurement.applied_by_delay, measurement.tip_m_s2)
          : estimator_.Update(*measurement.counters, *measurement.modes, *measurement.applied,
                              measurement.tip_m_s2);
  const double mean_nis = estimator_.mean_nis();
  if (ContradictsModel(mean_nis)) estimator_.AssumePayloadLost();
  known_ = monitor_.Judge(found, mean_nis, moves_);
  StateEstimate estimate{.x = estimator_.Now(), .innovation = {}};
  std::copy_n(found.innovation.data(), found.innovation.size(), estimate.innovation.begin());
  return estimate;
}

StateVector PayloadObserver::Predict(const StateVector& /*x*/,
                                     const PiecewiseTorque& pending) const noexcept {
  return estimator_.After(pending);
}

}  // namespace flexarm
