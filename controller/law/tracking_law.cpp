#include "controller/law/tracking_law.h"

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <utility>

namespace flexarm {
namespace {

// Proportional-derivative feedback of each hub to its own torque, 2 x n.
Eigen::MatrixXd PdGain(const ControllerConfig& config, const StateLayout& layout) {
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(2, layout.states());
  for (int joint = 0; joint < 2; ++joint) {
    const int hub = layout.hub(joint);
    K(joint, hub) = config.pd_stiffness_nm_per_rad[static_cast<std::size_t>(joint)];
    K(joint, layout.rate(hub)) = config.pd_damping_nms_per_rad[static_cast<std::size_t>(joint)];
  }
  return K;
}

// -K without the columns of the joints' angles and rates: in the reference the links are at rest.
Eigen::MatrixXd LinksAtRest(const Eigen::MatrixXd& K, const StateLayout& layout) {
  Eigen::MatrixXd without = -K;
  without.leftCols(layout.angles()).setZero();
  without.middleCols(layout.dof(), layout.angles()).setZero();
  return without;
}

// K_I(0) = [I, S21, S22], 2 x (n + 4).
Eigen::MatrixXd InitialGain(const Design& design) {
  Eigen::MatrixXd K_I0(2, design.A.rows() + 4);
  K_I0 << Eigen::Matrix2d::Identity(), design.S21, design.S22;
  return K_I0;
}

bool FollowsCommandGenerator(ControllerKind kind) {
  return IsAdaptive(kind) || kind == ControllerKind::kLqrCgt;
}

}  // namespace

Eigen::MatrixXd FeedbackGain(const Design& design, const ControllerConfig& config) {
  if (IsAdaptive(config.kind) && config.matrices) return OutputFeedback(config) * design.K;
  return IsPd(config.kind) ? PdGain(config, design.layout) : design.K;
}

TrackingLaw::TrackingLaw(const Design& design, const ControllerConfig& config,
                         const std::array<double, 2>& torque_limit_nm,
                         std::optional<SettleTerm> settle)
    : config_(config),
      torque_limit_nm_(torque_limit_nm),
      states_(design.A.rows()),
      Cp_(IsPd(config.kind) ? PdGain(config, design.layout) : design.K),
      G_(design.G),
      feedforward_x_(Matrix2n::Zero(2, states_)),
      feedforward_u_(Eigen::Matrix2d::Zero()),
      P_(design.P),
      S11_(design.S11),
      S12_(design.S12),
      K_I_(InitialGain(design), config),
      settle_(std::move(settle)) {
  config_.adaptation = config.adaptation && IsAdaptive(config.kind);
  SetFeedforward(design);
  if (config.matrices && IsAdaptive(config.kind)) SetMatrices(design);
}

void TrackingLaw::SetMatrices(const Design& design) {
  const AdaptationMatrices matrices = MatricesOf(config_, design);
  has_matrices_ = true;
  Tbar_ = matrices.Tbar;
  K_e_ = matrices.K_e;
  StS_inverse_ = (matrices.S.transpose() * matrices.S).inverse();  // start-up
  K_I_ = AdaptiveGain(matrices, config_);
}

void TrackingLaw::SetFeedforward(const Design& design) {
  switch (config_.kind) {
    case ControllerKind::kSobel:
    case ControllerKind::kSobelThesis: {
      // (7.24) with (7.25): the minus sign in front of (A_m - A) as printed, or the derived sign.
      const double sign = config_.feedforward_sign == FeedforwardSign::kPrinted ? -1.0 : 1.0;
      const double vartheta = config_.vartheta;
      feedforward_x_ = vartheta * sign * design.Ufx + (1.0 - vartheta) * design.S21;
      feedforward_u_ = vartheta * design.Ufu + (1.0 - vartheta) * design.S22;
      break;
    }
    case ControllerKind::kSobelOriginal:
    case ControllerKind::kLqrCgt:
      feedforward_x_ = design.S21;
      feedforward_u_ = design.S22;
      break;
    case ControllerKind::kLqrUm:
    case ControllerKind::kPd:
    case ControllerKind::kPdZv:
    case ControllerKind::kPdZvd:
      feedforward_u_.setIdentity();
      break;
    case ControllerKind::kLqg:
      feedforward_x_ = LinksAtRest(Cp_, design.layout);
      break;
    case ControllerKind::kGainScheduled:
    case ControllerKind::kRecedingHorizon:
      break;  // not made by this class: scheduled_law.h
  }
}

Eigen::Vector2d TrackingLaw::Feedforward(const StateVector& x_m,
                                         const Eigen::Vector2d& u_m) const noexcept {
  const Eigen::Vector2d from_state = feedforward_x_.lazyProduct(x_m);
  const Eigen::Vector2d from_command = feedforward_u_.lazyProduct(u_m);
  return from_state + from_command;
}

double TrackingLaw::Lyapunov(const StateVector& x, const StateVector& x_m,
                             const Eigen::Vector2d& u_m) const noexcept {
  // P is that of the loop with K_e = I.
  if (has_matrices_ && K_e_ != Eigen::Matrix2d::Identity()) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  if (!FollowsCommandGenerator(config_.kind)) return std::numeric_limits<double>::quiet_NaN();
  StateVector e = S11_.lazyProduct(x_m);  // e = x* - x
  e += S12_.col(0) * u_m(0) + S12_.col(1) * u_m(1);
  e -= x;
  const StateVector Pe = P_.lazyProduct(e);
  return e.dot(Pe) + K_I_.energy();
}

LawOutput TrackingLaw::Compute(const StateVector& x, const ReferenceSample& reference,
                               bool may_adapt, const PayloadKnowledge& payload,
                               double settling_share) noexcept {
  StateVector x_m(states_);
  for (Eigen::Index i = 0; i < states_; ++i) x_m(i) = reference.x_m[static_cast<std::size_t>(i)];
  const Eigen::Vector2d u_m(reference.u_m_nm[0], reference.u_m_nm[1]);
  const Eigen::Vector2d y_e = Cp_.lazyProduct(x_m - x);
  const Eigen::Vector2d fed_back = has_matrices_ ? Eigen::Vector2d(K_e_.lazyProduct(y_e)) : y_e;
  const Eigen::Vector2d u_star = Feedforward(x_m, u_m);
  const double lyapunov = Lyapunov(x, x_m, u_m);
  Eigen::Vector2d settling = Eigen::Vector2d::Zero();
  if (settle_) settling = settle_->Torque(x, x_m, settling_share, y_e, u_star + y_e, payload);
  if (!config_.adaptation) {
    LawOutput result = Saturate(u_star + fed_back + settling, torque_limit_nm_);
    result.lyapunov_nm2 = lyapunov;
    return result;
  }

  AdaptiveGain::Regressor r(2 + states_ + 2);
  r.head<2>() = y_e;
  r.segment(2, states_) = x_m;
  r.tail<2>() = u_m;
  const double rho = has_matrices_ ? r.dot(AdaptiveGain::Regressor(Tbar_.lazyProduct(r)))
                                   : config_.adaptation_gain * r.squaredNorm();
  const Eigen::Vector2d from_gain = K_I_.Torque(r);

  // C_p e = y_e, because C_p S11 = C_m and C_p S12 = 0 make C_p x* = C_m x_m.
  const Eigen::Vector2d F_e = has_matrices_ ? Eigen::Vector2d(StS_inverse_.lazyProduct(y_e)) : y_e;
  const Eigen::Vector2d drive = F_e + G_.lazyProduct(u_star + fed_back - from_gain);
  const Eigen::Matrix2d loop = Eigen::Matrix2d::Identity() + rho * G_;
  const double determinant = loop(0, 0) * loop(1, 1) - loop(0, 1) * loop(1, 0);
  const Eigen::Vector2d v((loop(1, 1) * drive(0) - loop(0, 1) * drive(1)) / determinant,
                          (loop(0, 0) * drive(1) - loop(1, 0) * drive(0)) / determinant);

  LawOutput result = Saturate(from_gain + rho * v + settling, torque_limit_nm_);
  result.lyapunov_nm2 = lyapunov;
  if (!may_adapt || result.limits != 0 || !result.finite) {
    result.limits |= kAdaptationHeld;
    return result;
  }
  K_I_.Update(v, r);
  return result;
}

}  // namespace flexarm
