#include "model/linearization.h"

#include <Eigen/Dense>
#include <cmath>
#include <complex>

#include "model/arm_equations.h"

namespace flexarm {
namespace {

using Complex = std::complex<double>;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kPi = 3.14159265358979323846;
constexpr double kStep = 1e-30;  // any value whose square vanishes: nothing is subtracted

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

VectorXd InHz(const VectorXd& squared) { return squared.cwiseMax(0.0).cwiseSqrt() / (2.0 * kPi); }

}  // namespace

LinearModel Linearize(const ArmModel& model, const VectorXd& q, const VectorXd& v,
                      const Eigen::Vector2d& torque_nm) {
  return LinearizeAlong(model, q, v, model.Acceleration(q, v, model.InputMatrix() * torque_nm));
}

LinearModel LinearizeAlong(const ArmModel& model, const VectorXd& q, const VectorXd& v,
                           const VectorXd& a) {
  const Eigen::Index n = model.dof();
  const VectorX<Complex> qc = q.cast<Complex>(), vc = v.cast<Complex>(), ac = a.cast<Complex>();
  const auto derivative = [&](const VectorX<Complex>& at_q, const VectorX<Complex>& at_v) {
    return VectorXd(InertialForces<Complex>(model.constants(), at_q, at_v, ac).imag() / kStep);
  };
  MatrixXd F_q = model.stiffness(), F_v = model.damping();
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
