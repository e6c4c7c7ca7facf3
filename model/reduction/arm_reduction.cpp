#include "model/reduction/arm_reduction.h"

#include <cmath>

#include "model/arm/linearization.h"
#include "model/math/dense_decompositions.h"

namespace flexarm {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd ElbowAt(const ArmModel& model, double theta2_rad) {
  VectorXd q = VectorXd::Zero(model.dof());
  q[kTheta2] = q[kTheta4] = theta2_rad;
  return q;
}

// d(tip position)/dq: the tip's velocity is linear in the rates.
MatrixXd TipJacobian(const ArmModel& model, const VectorXd& q) {
  MatrixXd C(2, model.dof());
  for (Index i = 0; i < model.dof(); ++i) {
    C.col(i) = model.TipVelocity(q, VectorXd::Unit(model.dof(), i));
  }
  return C;
}

LinearModel LinearizeAbout(const ArmModel& model, const NominalMotion& motion, const VectorXd& q) {
  VectorXd v = VectorXd::Zero(model.dof());
  v[kTheta1] = v[kTheta3] = motion.theta1_rate_rad_s;
  v[kTheta2] = v[kTheta4] = motion.theta2_rate_rad_s;
  return LinearizeAlong(model, q, v, VectorXd::Zero(model.dof()));
}

LinkContribution Contribution(const VectorXd& mu_tip, const LinkModes& link, ModalScaling scaling) {
  LinkContribution out{mu_tip.cwiseProduct(ModalScale(link, scaling).cwiseAbs2()), mu_tip};
  double sum = 0.0;
  for (Index i = 0; i < mu_tip.size(); ++i) {
    sum += out.mu[i];
    out.epsilon_percent[i] = 100.0 * sum / out.mu.sum();
  }
  return out;
}

}  // namespace

VectorXd ModalScale(const LinkModes& link, ModalScaling scaling) {
  VectorXd scale = VectorXd::Ones(link.count());
  for (int i = 0; i < link.count(); ++i) {
    const double omega = link.mode[static_cast<std::size_t>(i)].frequency_rad_s();
    // Strain and kinetic energy of a mode are equal: the modal mass, tip included, is G / omega^2.
    if (scaling == ModalScaling::kMass) scale[i] = std::sqrt(link.G(i, i)) / omega;
    if (scaling == ModalScaling::kLength) scale[i] = std::sqrt(link.N(i, i) / link.m);
  }
  return scale;
}

UndampedSystem UndampedArm(const ArmModel& model, const NominalMotion& motion) {
  const Index n = model.dof();
  const VectorXd q = ElbowAt(model, motion.theta2_rad);
  const LinearModel linear = LinearizeAbout(model, motion, q);
  return {MatrixXd::Identity(n, n), -linear.A.bottomLeftCorner(n, n), linear.B.bottomRows(n),
          TipJacobian(model, q)};
}

UndampedSystem UndampedArmAtRest(const ArmModel& model, double theta2_rad) {
  const VectorXd q = ElbowAt(model, theta2_rad);
  const MatrixXd inverse =
      model.MassMatrix(q).llt().solve(MatrixXd::Identity(model.dof(), model.dof()));
  return {0.5 * (inverse + inverse.transpose()), model.stiffness(), model.InputMatrix(),
          TipJacobian(model, q)};
}

StateSpace DampedArm(const ArmModel& model, const NominalMotion& motion) {
  const VectorXd q = ElbowAt(model, motion.theta2_rad);
  LinearModel linear = LinearizeAbout(model, motion, q);
  MatrixXd C = MatrixXd::Zero(2, 2 * Index{model.dof()});
  C.leftCols(model.dof()) = TipJacobian(model, q);
  return {std::move(linear.A), std::move(linear.B), std::move(C)};
}

ArmReduction ReduceArm(const ArmModel& model, const NominalMotion& motion, ModalScaling scaling,
                       double rigid_below_rad2_s2) {
  ArmReduction out;
  out.balance = BalancePower(UndampedArm(model, motion),
                             {.rigid_below_rad2_s2 = rigid_below_rad2_s2, .rigid_roots = 2});
  const ArmConstants& c = model.constants();
  out.link[0] = Contribution(out.balance.mu.segment(kPhi1, c.m1), c.link1, scaling);
  out.link[1] = Contribution(out.balance.mu.tail(c.m2), c.link2, scaling);
  return out;
}

}  // namespace flexarm
