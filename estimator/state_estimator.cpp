#include "estimator/state_estimator.h"

#include <algorithm>

namespace flexarm {

StateEstimator::StateEstimator(const EstimatorConfig& config, const FilterGains& gains,
                               double period_s,
                               const std::array<double, 2>& joint_stiffness_nm_per_rad)
    : kind_(config.kind),
      layout_(gains.layout),
      fitted_modes_(std::min(config.modes_per_link, gains.layout.modes_per_link)),
      period_s_(period_s),
      joint_stiffness_(joint_stiffness_nm_per_rad),
      hold_({.A = gains.A, .B = gains.B}, gains.A_rate, gains.B_rate, period_s),
      C_(gains.C),
      L_(gains.L),
      covariance_(gains.A, gains.C, gains.W, gains.R, gains.P),
      modal_rate_x_(gains.C.bottomRows(2 * gains.layout.modes_per_link) * gains.A_rate),
      modal_rate_u_(gains.C.bottomRows(2 * gains.layout.modes_per_link) * gains.B_rate) {
  for (Eigen::Index i = 0; i < L_.cols(); ++i) {
    if (!L_.col(i).isZero(0.0)) needed_ |= std::uint32_t{1} << i;
  }
  Reset();
}

void StateEstimator::Reset() noexcept {
  x_ = FilterVector::Zero(L_.rows());
  y_before_ = OutputVector::Zero(C_.rows());
  covariance_.Reset();
  predicted_under_ = {};
  missing_ = {};
  started_ = false;
}

// y = [th1, th2, th3, th4, f..]. A rotor leads its hub by the torsion u/K, which a model with rigid
// joints does not contain: it gets th3 - u1/K1, th4 - u2/K2, u the torque that acts at the sample,
// as the springs settle within a few ms.
StateEstimator::OutputVector StateEstimator::Measure(const DecodedCounters& counters,
                                                     const FittedModes& modes,
                                                     const std::array<double, 2>& torque_nm,
                                                     std::uint32_t* good) const noexcept {
  OutputVector y = OutputVector::Zero(C_.rows());
  *good = counters.good;
  for (Eigen::Index i = 0; i < 4; ++i) y(i) = counters.angle_rad[static_cast<std::size_t>(i)];
  for (int i = 0; i < 2; ++i) {
    const auto link = static_cast<std::size_t>(i);
    if (!layout_.torsion) y(2 + i) -= torque_nm[link] / joint_stiffness_[link];
    for (int j = 0; j < layout_.modes_per_link; ++j) {
      const int row = layout_.output(layout_.mode(i, j));
      y(row) = modes.modal_m[2 * link + static_cast<std::size_t>(j)];
      if (modes.valid[link] && j < fitted_modes_) *good |= std::uint32_t{1} << row;
    }
  }
  return y;
}

std::array<double, 4> StateEstimator::ModalRates(const PiecewiseTorque& applied) noexcept {
  const auto modes = static_cast<std::size_t>(layout_.modes_per_link);
  const Eigen::Index flex = Eigen::Index{2} * layout_.modes_per_link;
  OutputVector rate = OutputVector::Zero(flex);
  if (started_ && kind_ == EstimatorKind::kKalman) {
    const std::array<double, 2> torque_nm = applied.last_nm();
    rate = modal_rate_x_.lazyProduct(Predicted(applied));
    rate += modal_rate_u_.col(0) * torque_nm[0];
    rate += modal_rate_u_.col(1) * torque_nm[1];
  } else if (started_) {
    rate = x_.segment(layout_.dof() + layout_.mode(0, 0), flex);
  }
  std::array<double, 4> out{};
  for (std::size_t link = 0; link < 2; ++link) {
    for (std::size_t mode = 0; mode < modes; ++mode) {
      out[2 * link + mode] = rate(static_cast<Eigen::Index>(link * modes + mode));
    }
  }
  return out;
}

StateEstimator::Estimate StateEstimator::Update(const DecodedCounters& counters,
                                                const FittedModes& modes,
                                                const PiecewiseTorque& applied) noexcept {
  std::uint32_t good = 0;
  const OutputVector y = Measure(counters, modes, applied.last_nm(), &good);
  if (!started_) {
    started_ = true;
    StartAtRest(y);
    return {.x = x_.head(layout_.states()), .innovation = {}};
  }
  return kind_ == EstimatorKind::kKalman ? UpdateKalman(y, good, applied)
                                         : UpdateDifference(y, good);
}

void StateEstimator::StartAtRest(const OutputVector& y) noexcept {
  const int n = layout_.states(), flex = 2 * layout_.modes_per_link;
  x_.setZero();
  for (int joint = 0; joint < 2; ++joint)
    x_(layout_.hub(joint)) = x_(layout_.rotor(joint)) = y(joint);
  for (int i = 0; i < flex; ++i) {
    x_(layout_.mode(0, 0) + i) = y(4 + i);
    if (x_.size() > n) x_(n + i) = y(4 + i);
  }
  y_before_ = y;
}

// x(k|k-1) = A x(k-1|k-1) + B u(k-1), in as many pieces as u has. ModalRates and Update of a sample
// both need it.
const StateEstimator::FilterVector& StateEstimator::Predicted(
    const PiecewiseTorque& applied) noexcept {
  if (applied.all().empty() || !(applied == predicted_under_)) {
    predicted_ = x_;
    hold_.Advance(applied, &predicted_);
    predicted_under_ = applied;
  }
  return predicted_;
}

StateEstimator::Estimate StateEstimator::UpdateKalman(const OutputVector& y, std::uint32_t good,
                                                      const PiecewiseTorque& applied) noexcept {
  FilterVector x = Predicted(applied);
  predicted_under_ = {};
  const OutputVector predicted = C_.lazyProduct(x);
  const bool complete = (good & needed_) == needed_;
  const bool steady = complete && covariance_.steady();
  Estimate out{};
  for (Eigen::Index i = 0; i < y.size(); ++i) {
    if ((good >> i & 1u) == 0) continue;
    const double innovation = y(i) - predicted(i);
    out.innovation[static_cast<std::size_t>(i)] = innovation;
    if (steady) x += L_.col(i) * innovation;
  }
  if (!steady) covariance_.Correct(y, good & needed_, complete, &x);
  x_ = x;
  out.x = x_.head(layout_.states());
  return out;
}

StateEstimator::Estimate StateEstimator::UpdateDifference(const OutputVector& y,
                                                          std::uint32_t good) noexcept {
  for (int i = 0; i < layout_.dof(); ++i) {
    const int row = layout_.output(i), rate = layout_.rate(i);
    int& missing = missing_[static_cast<std::size_t>(row)];
    ++missing;  // periods since the last reading
    if ((good >> row & 1u) != 0) {
      x_(rate) = (y(row) - y_before_(row)) / (missing * period_s_);
      x_(i) = y_before_(row) = y(row);
      missing = 0;
    } else {
      x_(i) = y_before_(row) + missing * period_s_ * x_(rate);
    }
  }
  Estimate out{};
  out.x = x_.head(layout_.states());
  return out;
}

}  // namespace flexarm
