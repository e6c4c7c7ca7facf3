#include "controller/design/straight_arm_model.h"

#include "model/math/dense_decompositions.h"
#include "model/math/library_math.h"

namespace flexarm {

NominalModel StraightArmModel(const RigidJointArm& arm, double payload_kg, double theta2_rad) {
  constexpr Eigen::Index n = RigidJointArm::kDof;
  const RigidJointArm::Vector rest = RigidJointArm::Vector::Zero();
  const RigidJointArm::Vector q = theta2_rad * RigidJointArm::Vector::Unit(1);
  NominalModel model{.layout = kR12,
                     .M = arm.At<LibraryMath>(arm.Outboard(payload_kg), q, rest).M,
                     .D = arm.damping(),
                     .K = arm.stiffness(),
                     .A = Eigen::MatrixXd::Zero(2 * n, 2 * n),
                     .B = Eigen::MatrixXd::Zero(2 * n, 2),
                     .torque_mode_rad_s = {}};
  const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(n, n);
  const Eigen::LLT<Eigen::MatrixXd> M(model.M);
  model.A.topRightCorner(n, n).setIdentity();
  model.A.bottomLeftCorner(n, n) = -M.solve(model.K);
  model.A.bottomRightCorner(n, n) = -M.solve(model.D);
  model.B.bottomRows(n) = M.solve(I).leftCols<2>();
  return model;
}

}  // namespace flexarm
