#include "controller/law/gain_table.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <stdexcept>
#include <utility>

#include "model/dense_decompositions.h"
#include "model/discretize.h"
#include "model/library_math.h"
#include "model/riccati.h"

namespace flexarm {
namespace {

/// Between knots `first` and `first + 1`, `share` of the way.
struct Place {
  std::size_t first;
  double share;
};

Place PlaceIn(const std::vector<double>& knots, double x) noexcept {
  const auto above = std::upper_bound(knots.begin() + 1, knots.end() - 1, x);
  const auto first = static_cast<std::size_t>(above - knots.begin()) - 1;
  const double share = (x - knots[first]) / (knots[first + 1] - knots[first]);
  return {.first = first, .share = std::clamp(share, 0.0, 1.0)};
}

void RequireAscending(const std::vector<double>& knots) {
  if (knots.size() < 2 ||
      std::adjacent_find(knots.begin(), knots.end(), std::greater_equal<>()) != knots.end()) {
    throw std::invalid_argument("a gain table's axis must ascend and have at least two knots");
  }
}

// At rest and unbent the model is linear: M q'' + D q' + K q = [u; 0].
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

GainTable::GainTable(GainGrid grid, std::vector<Gain> knots)
    : grid_(std::move(grid)), knots_(std::move(knots)) {
  RequireAscending(grid_.payload_kg);
  RequireAscending(grid_.theta2_rad);
  if (knots_.size() != grid_.payload_kg.size() * grid_.theta2_rad.size()) {
    throw std::invalid_argument("a gain table needs a gain for every knot of its grid");
  }
}

GainTable::Gain GainTable::At(double payload_kg, double theta2_rad) const noexcept {
  const Place m = PlaceIn(grid_.payload_kg, payload_kg);
  const Place th2 = PlaceIn(grid_.theta2_rad, std::fabs(theta2_rad));
  const Gain low =
      (1.0 - th2.share) * Knot(m.first, th2.first) + th2.share * Knot(m.first, th2.first + 1);
  const Gain high = (1.0 - th2.share) * Knot(m.first + 1, th2.first) +
                    th2.share * Knot(m.first + 1, th2.first + 1);
  return (1.0 - m.share) * low + m.share * high;
}

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
