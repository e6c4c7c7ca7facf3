#include "estimator/state_estimator.h"

namespace flexarm {

StateEstimator::StateEstimator(const EstimatorConfig& config, const FilterGains& gains,
                               double period_s,
                               const std::array<double, 2>& joint_stiffness_nm_per_rad)
    : kind_(config.kind),
      period_s_(period_s),
      joint_stiffness_(joint_stiffness_nm_per_rad),
      modes_(config.modes_per_link),
      states_(2 * (2 + 2 * config.modes_per_link)),
      A_(gains.A),
      B_(gains.B),
      C_(gains.C),
      L_(gains.L) {
  Reset();
}

void StateEstimator::Reset() noexcept {
  x_ = FilterVector::Zero(A_.rows());
  y_before_ = OutputVector::Zero(C_.rows());
  started_ = false;
}

// y = [th1, th2, th3 - u1/K1, th4 - u2/K2, f..]: a rotor leads its hub by the torsion u/K.
StateEstimator::OutputVector StateEstimator::Measure(const DecodedCounters& counters,
                                                     const FittedModes& modes,
                                                     const std::array<double, 2>& torque_nm,
                                                     std::uint32_t* good) const noexcept {
  OutputVector y = OutputVector::Zero(C_.rows());
  *good = counters.good;
  y(0) = counters.angle_rad[0];
  y(1) = counters.angle_rad[1];
  y(2) = counters.angle_rad[2] - torque_nm[0] / joint_stiffness_[0];
  y(3) = counters.angle_rad[3] - torque_nm[1] / joint_stiffness_[1];
  for (int i = 0; i < 2 * modes_; ++i) {
    const std::size_t link = i < modes_ ? 0 : 1;
    const std::size_t mode = static_cast<std::size_t>(i % modes_);
    y(4 + i) = modes.modal_m[2 * link + mode];
    if (modes.valid[link]) *good |= std::uint32_t{1} << (4 + i);
  }
  return y;
}

StateEstimator::Estimate StateEstimator::Update(
    const DecodedCounters& counters, const FittedModes& modes,
    const std::array<double, 2>& applied_torque_nm) noexcept {
  std::uint32_t good = 0;
  const OutputVector y = Measure(counters, modes, applied_torque_nm, &good);
  if (!started_) {
    started_ = true;
    x_.setZero();
    x_(0) = y(0);
    x_(1) = y(1);
    for (int i = 0; i < 2 * modes_; ++i) {
      x_(2 + i) = y(4 + i);
      if (x_.size() > states_) x_(states_ + i) = y(4 + i);
    }
    y_before_ = y;
    return {.x = x_.head(states_), .innovation = {}};
  }
  return kind_ == EstimatorKind::kKalman ? UpdateKalman(y, good, applied_torque_nm)
                                         : UpdateDifference(y, good);
}

StateEstimator::Estimate StateEstimator::UpdateKalman(
    const OutputVector& y, std::uint32_t good, const std::array<double, 2>& torque_nm) noexcept {
  // x(k|k-1) = A x(k-1|k-1) + B u(k-1)
  FilterVector x = A_.lazyProduct(x_);
  x += B_.col(0) * torque_nm[0];
  x += B_.col(1) * torque_nm[1];
  const OutputVector predicted = C_.lazyProduct(x);
  Estimate out{};
  for (Eigen::Index i = 0; i < y.size(); ++i) {
    if ((good >> i & 1u) == 0) continue;
    const double innovation = y(i) - predicted(i);
    out.innovation[static_cast<std::size_t>(i)] = innovation;
    x += L_.col(i) * innovation;
  }
  x_ = x;
  out.x = x_.head(states_);
  return out;
}

StateEstimator::Estimate StateEstimator::UpdateDifference(const OutputVector& y,
                                                          std::uint32_t good) noexcept {
  const Eigen::Index dof = states_ / 2;
  for (Eigen::Index i = 0; i < dof; ++i) {
    const Eigen::Index row = i < 2 ? i : i + 2;  // hub angles, then modal coordinates
    const double change =
        (good >> row & 1u) != 0 ? y(row) - y_before_(row) : x_(dof + i) * period_s_;
    x_(dof + i) = change / period_s_;
    y_before_(row) += change;
    x_(i) = y_before_(row);
  }
  Estimate out{};
  out.x = x_.head(states_);
  return out;
}

}  // namespace flexarm
