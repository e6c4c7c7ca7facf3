#include "model/rigid_joint_arm.h"

#include "model/arm_model.h"

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

  Eigen::Matrix<double, 8, kDof> T_r = Eigen::Matrix<double, 8, kDof>::Zero();
  T_r(kTheta1, 0) = T_r(kTheta3, 0) = T_r(kTheta2, 1) = T_r(kTheta4, 1) = 1.0;
  T_r.bottomRightCorner<4, 4>().setIdentity();
  stiffness_ = T_r.transpose() * model.stiffness() * T_r;
  damping_ = T_r.transpose() * model.damping() * T_r;
}

OutboardBody RigidJointArm::Outboard(double payload_kg) const noexcept {
  const double m = payload_kg;
  return {.m = empty_.m + m * per_kg_.m,
          .Sx = empty_.Sx + m * per_kg_.Sx,
          .I2 = empty_.I2 + m * per_kg_.I2,
          .k2 = empty_.k2 + m * per_kg_.k2,
          .a2 = empty_.a2 + m * per_kg_.a2,
          .N2 = empty_.N2 + m * per_kg_.N2};
}

}  // namespace flexarm
