#include "controller/design/gain_table_design.h"

#include <cmath>
#include <utility>
#include <vector>

#include "controller/design/straight_arm_model.h"
#include "model/math/discretize.h"
#include "model/math/riccati.h"

namespace flexarm {
namespace {

DiscreteModel SampledAt(const RigidJointArm& arm, double payload_kg, double theta2_rad,
                        double period_s) {
  const NominalModel model = StraightArmModel(arm, payload_kg, theta2_rad);
  return ZeroOrderHold(model.A, model.B, period_s);
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
