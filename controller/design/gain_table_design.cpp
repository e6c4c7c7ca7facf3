#include "controller/design/gain_table_design.h"

#include <cmath>
#include <utility>
#include <vector>

#include "model/math/dense_decompositions.h"
#include "model/math/discretize.h"
#include "model/math/library_math.h"
#include "model/math/riccati.h"

namespace flexarm {
namespace {

// Linear model at rest with straight links: M q'' + D q' + K q = [u; 0].
DiscreteModel SampledAt(const RigidJointArm& arm, double payload_kg, double theta2_rad,
                        double period_s) {
  constexpr Eigen::Index n = RigidJointArm::kDof;
  const RigidJointArm::Vector rest = RigidJointArm::Vector::Zero();
  const RigidJointArm::Vector q = theta2_rad * RigidJointArm::Vector::Unit(1);
  const Eigen::MatrixXd mass = arm.At<LibraryMath>(arm.Outboard(payload_kg), q, rest).M;
  const Eigen::MatrixXd stiffness = arm.stiffness(), damping = arm.damping();
  const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(n, n);
  const Eigen::LLT<Eigen::MatrixXd> M(mass);
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(2 * n, 2 * n), B = Eigen::MatrixXd::Zero(2 * n, 2);
  A.topRightCorner(n, n).setIdentity();
  A.bottomLeftCorner(n, n) = -M.solve(stiffness);
  A.bottomRightCorner(n, n) = -M.solve(damping);
  B.bottomRows(n) = M.solve(I).leftCols<2>();
  return ZeroOrderHold(A, B, period_s);
}

}  // namespace

GainTable DesignGainTable(const RigidJointArm& arm, const GainGrid& grid,
                          const GainWeights& weights, double period_s) {
  const double a = std::exp(weights.alpha_per_s * period_s);
  const Eigen::MatrixXd Q =
      (Eigen::VectorXd::Map(weights.state.data(), 12) / weights.torque).asDiagonal();
  const Eigen::Matrix2d I2 = Eigen::Matrix2d::Identity();
  std::vector<GainTable::Gain> knots;
  for (const double payload_kg : grid.payload_kg) {
    for (const double theta2_rad : grid.theta2_rad) {
      const DiscreteModel model = SampledAt(arm, payload_kg, theta2_rad, period_s);
      const Eigen::MatrixXd A = a * model.A, B = a * model.B;
      knots.emplace_back(DareGain(A, B, I2, SolveDare(A, B, Q, I2)));
    }
  }
  return {grid, std::move(knots)};
}

}  // namespace flexarm
