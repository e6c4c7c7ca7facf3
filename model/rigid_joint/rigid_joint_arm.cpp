#include "model/rigid_joint/rigid_joint_arm.h"

#include <stdexcept>
#include <string>

#include "model/arm/arm_model.h"
#include "model/rigid_joint/tip_acceleration.h"

namespace flexarm {
namespace {

OutboardBody BodyWith(ArmParameters p, double payload_kg) {
  p.payload_mass_kg = payload_kg;
  const ArmConstants c(p, {2, 2});
  return {.m = c.m_outboard, .Sx = c.Sx, .I2 = c.I2 + c.J2, .k2 = c.k2, .a2 = c.a2, .N2 = c.N2};
}

}  // namespace

RigidJointArm::RigidJointArm(const ArmParameters& parameters)
    : empty_(BodyWith(parameters, 0.0)), per_kg_(BodyWith(parameters, 1.0)) {
  per_kg_.m -= empty_.m;
  per_kg_.Sx -= empty_.Sx;
  per_kg_.I2 -= empty_.I2;
  per_kg_.k2 -= empty_.k2;
  per_kg_.a2 -= empty_.a2;
  per_kg_.N2 -= empty_.N2;

  const ArmModel model(parameters, {2, 2});
  const ArmConstants& c = model.constants();
  L1_ = c.L1;
  I1_ = c.I1 + c.J1;
  Ir2_ = c.Ir2;
  Ip_ = c.Ip;
  a1_ = c.link1.a;
  p1_ = c.link1.psi_tip;
  s1_ = c.link1.slope_tip;
  N1_ = c.link1.N;
  s2_ = c.link2.slope_tip;

  Eigen::MatrixXd T_r = Eigen::MatrixXd::Zero(8, kDof);
  T_r(kTheta1, 0) = T_r(kTheta3, 0) = T_r(kTheta2, 1) = T_r(kTheta4, 1) = 1.0;
  T_r.bottomRightCorner<4, 4>().setIdentity();
  stiffness_ = T_r.transpose() * model.stiffness() * T_r;
  damping_ = T_r.transpose() * model.damping() * T_r;
}

// Defines the order of the constants for writing and reading.
template <typename Arm, typename Visit>
void RigidJointArm::ForEachConstant(Arm& arm, Visit visit) {
  const auto visit_all = [&visit](auto& matrix) {
    for (Eigen::Index i = 0; i < matrix.size(); ++i) visit(matrix.data()[i]);
  };
  visit(arm.L1_), visit(arm.I1_), visit(arm.Ir2_), visit(arm.Ip_);
  visit_all(arm.a1_), visit_all(arm.p1_), visit_all(arm.s1_), visit_all(arm.N1_);
  visit_all(arm.s2_);
  for (auto* body : {&arm.empty_, &arm.per_kg_}) {
    visit(body->m), visit(body->Sx), visit(body->I2);
    visit_all(body->k2), visit_all(body->a2), visit_all(body->N2);
  }
  visit_all(arm.stiffness_), visit_all(arm.damping_);
}

std::vector<double> RigidJointArm::Constants() const {
  std::vector<double> constants;
  ForEachConstant(*this, [&constants](double value) { constants.push_back(value); });  // start-up
  return constants;
}

RigidJointArm::RigidJointArm(std::span<const double> constants) {
  std::size_t used = 0;
  ForEachConstant(*this, [&](double& value) {
    if (used < constants.size()) value = constants[used];
    ++used;
  });
  if (used == constants.size()) return;
  throw std::invalid_argument("an arm with rigid joints has " + std::to_string(used) +  // start-up
                              " constants, not " + std::to_string(constants.size()));   // start-up
}

double RigidJointArm::TipAcceleration(const Vector& q, const Vector& v,
                                      const Vector& a) const noexcept {
  const auto link1 = [](const Eigen::Vector2d& shape, const Vector& x) {
    return shape.dot(x.segment<2>(2));
  };
  // A unit payload mass contains the tip's position: its first moment is L2, k2 is psi2(L2).
  const double L2 = per_kg_.Sx;
  const auto w2 = [this](const Vector& x) { return per_kg_.k2.dot(x.tail<2>()); };
  return flexarm::TipAcceleration({.theta1 = {q[0], v[0], a[0]},
                                   .theta2 = {q[1], v[1], a[1]},
                                   .length1 = {L1_, 0.0, 0.0},
                                   .length2 = {L2, 0.0, 0.0},
                                   .w1 = {link1(p1_, q), link1(p1_, v), link1(p1_, a)},
                                   .w2 = {w2(q), w2(v), w2(a)},
                                   .slope1 = {link1(s1_, q), link1(s1_, v), link1(s1_, a)},
                                   .slope2 = s2_.dot(q.tail<2>())});
}

}  // namespace flexarm
