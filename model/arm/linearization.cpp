#include "model/arm/linearization.h"

#include <cmath>
#include <complex>

#include "model/arm/arm_equations.h"
#include "model/math/dense_decompositions.h"
#include "model/units.h"

namespace flexarm {
namespace {

using Complex = std::complex<double>;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kStep = 1e-30;  // any value whose square underflows: no subtraction

// Generalised K x = w^2 M x on the chosen coordinates; w^2 ascending.
VectorXd SquaredFrequencies(const ArmModel& model, double theta2, const Eigen::VectorXi& keep) {
  VectorXd q = VectorXd::Zero(model.dof());
  q[kTheta2] = q[kTheta4] = theta2;
  const MatrixXd M = model.MassMatrix(q);
  const MatrixXd& K = model.stiffness();
  const MatrixXd M_kept = M(keep, keep), K_kept = K(keep, keep);
  // Scale to a unit diagonal of M first: tip-normalised masses spread over four decades.
  const VectorXd t = M_kept.diagonal().cwiseSqrt().cwiseInverse();
  const MatrixXd M_scaled = t.asDiagonal() * M_kept * t.asDiagonal();
  const MatrixXd K_scaled = t.asDiagonal() * K_kept * t.asDiagonal();
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> eigen(K_scaled, M_scaled,
                                                                 Eigen::EigenvaluesOnly);
  return eigen.eigenvalues();
}

void AddBacklashSlopes(const ArmModel& model, const VectorXd& q, const VectorXd& v, MatrixXd* F_q,
                       MatrixXd* F_v) {
  const Backlash& backlash = model.constants().backlash;
  if (!backlash.active()) return;
  const Joint2Torque joint =
      backlash.At(q[kTheta4] - q[kTheta2], v[kTheta4] - v[kTheta2], v[kTheta4]);
  const auto add = [](MatrixXd* F, double slope) {  // of a torque between th4 and th2
    (*F)(kTheta2, kTheta2) += slope;
    (*F)(kTheta4, kTheta4) += slope;
    (*F)(kTheta2, kTheta4) -= slope;
    (*F)(kTheta4, kTheta2) -= slope;
  };
  add(F_q, joint.stiffness_nm_per_rad - model.constants().K2);
  add(F_v, joint.damping_nms_per_rad);
  (*F_v)(kTheta4, kTheta4) += joint.drag_slope_nms;
}

VectorXd InHz(const VectorXd& squared) { return squared.cwiseMax(0.0).cwiseSqrt() / (2.0 * kPi); }

// At accelerations a; `hub_damping` of smoothed friction at th1 and th2, N m s/rad.
LinearModel Jacobians(const ArmModel& model, const VectorXd& q, const VectorXd& v,
                      const VectorXd& a, const Eigen::Vector2d& hub_damping) {
  const Eigen::Index n = model.dof();
  MatrixXd F_q = model.stiffness(), F_v = model.damping();
  AddBacklashSlopes(model, q, v, &F_q, &F_v);
  F_v.diagonal().head<2>() += hub_damping;
  const VectorX<Complex> qc = q.cast<Complex>(), vc = v.cast<Complex>(), ac = a.cast<Complex>();
  const auto derivative = [&](const VectorX<Complex>& at_q, const VectorX<Complex>& at_v) {
    return VectorXd(InertialForces<Complex>(model.constants(), at_q, at_v, ac).imag() / kStep);
  };
  for (Eigen::Index i = 0; i < n; ++i) {
    VectorX<Complex> q_step = qc, v_step = vc;
    q_step[i] += Complex(0.0, kStep);
    v_step[i] += Complex(0.0, kStep);
    F_q.col(i) += derivative(q_step, vc);
    F_v.col(i) += derivative(qc, v_step);
  }
  const Eigen::LLT<MatrixXd> M(model.MassMatrix(q));
  LinearModel linear{MatrixXd::Zero(2 * n, 2 * n), MatrixXd::Zero(2 * n, 2)};
  linear.A.topRightCorner(n, n).setIdentity();
  linear.A.bottomLeftCorner(n, n) = -M.solve(F_q);
  linear.A.bottomRightCorner(n, n) = -M.solve(F_v);
  linear.B.bottomRows(n) = M.solve(model.InputMatrix());
  return linear;
}

}  // namespace

LinearModel Linearize(const ArmModel& model, const VectorXd& q, const VectorXd& v,
                      const Eigen::Vector2d& torque_nm, double friction_gain_s_per_rad) {
  const double k = friction_gain_s_per_rad;
  const Eigen::Array2d K_F = model.constants().friction_nm,
                       smooth = (k * v.head<2>()).array().tanh();
  VectorXd force = model.InputMatrix() * torque_nm;
  force.head<2>() -= (K_F * smooth).matrix();
  return Jacobians(model, q, v, model.Acceleration(q, v, force), k * K_F * (1.0 - smooth.square()));
}

LinearModel LinearizeAlong(const ArmModel& model, const VectorXd& q, const VectorXd& v,
                           const VectorXd& a) {
  return Jacobians(model, q, v, a, Eigen::Vector2d::Zero());
}

VectorXd FreeMotorFrequenciesHz(const ArmModel& model, double theta2_rad) {
  const Eigen::VectorXi all = Eigen::VectorXi::LinSpaced(model.dof(), 0, model.dof() - 1);
  return InHz(SquaredFrequencies(model, theta2_rad, all).tail(model.dof() - 2));
}

VectorXd HeldMotorFrequenciesHz(const ArmModel& model, double theta2_rad) {
  Eigen::VectorXi kept(model.dof() - 2);
  kept << int{kTheta1}, int{kTheta2},
      Eigen::VectorXi::LinSpaced(model.dof() - kRigidCoordinates, kPhi1, model.dof() - 1);
  return InHz(SquaredFrequencies(model, theta2_rad, kept));
}

}  // namespace flexarm
