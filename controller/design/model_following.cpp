#include "controller/design/model_following.h"

#include "estimator/nominal_model.h"
#include "model/math/dense_decompositions.h"
#include "model/math/discretize.h"
#include "model/math/invariant_zeros.h"
#include "model/math/matrix_scaling.h"

namespace flexarm {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

MatrixXd NextTo(const MatrixXd& left, const MatrixXd& right) {
  MatrixXd both(left.rows(), left.cols() + right.cols());
  both << left, right;
  return both;
}

MatrixXd UnitColumns(const MatrixXd& X) {
  const Eigen::VectorXd norm = X.colwise().norm();
  return X * norm.cwiseInverse().asDiagonal();
}

FollowingRanks RanksOf(const MatrixXd& A, const MatrixXd& B, const MatrixXd& Am,
                       const MatrixXd& Bm) {
  const Eigen::VectorXd scale = BalancingScale(A);
  const auto rows = scale.cwiseInverse().asDiagonal();
  const MatrixXd balanced = rows * A * scale.asDiagonal();
  const MatrixXd difference = rows * (A - Am) * scale.asDiagonal() / balanced.norm();
  const MatrixXd input = UnitColumns(rows * B), reference = UnitColumns(rows * Bm);
  return {.input = NumericalRank(input),
          .difference = NumericalRank(NextTo(input, difference)),
          .reference = NumericalRank(NextTo(input, reference))};
}

// [0, 1; -M^-1 K, -M^-1 D]
MatrixXd StateMatrix(const MatrixXd& M, const MatrixXd& D, const MatrixXd& K) {
  const Index n = M.rows();
  const Eigen::LLT<MatrixXd> factor(M);
  MatrixXd A = MatrixXd::Zero(2 * n, 2 * n);
  A.topRightCorner(n, n).setIdentity();
  A.bottomLeftCorner(n, n) = -factor.solve(K);
  A.bottomRightCorner(n, n) = -factor.solve(D);
  return A;
}

}  // namespace

ModelFollowing TestModelFollowing(const ControlConfig& config, const StateLayout& layout,
                                  const FollowingPlant& plant) {
  const NominalModel nominal = MakeNominalModel(config.arm, layout);
  const NominalModel reference = MakeReferenceModel(nominal);
  MatrixXd D = plant.damping_of_reference ? reference.D : nominal.D, K = nominal.K;
  for (int joint = 0; joint < 2; ++joint) {
    const int hub = layout.hub(joint);
    D(hub, hub) += plant.friction_gain_s_per_rad *
                   config.arm.joint[static_cast<std::size_t>(joint)].coulomb_friction_nm;
  }
  if (plant.in_clearance && layout.torsion) {
    for (const int i : {layout.hub(1), layout.rotor(1)}) K.row(i).setZero(), K.col(i).setZero();
  }
  const MatrixXd A = StateMatrix(nominal.M, D, K);
  const MatrixXd Am = StateMatrix(reference.M, reference.D, reference.K);
  const double period_s = config.loop.period_s();
  const DiscreteModel discrete = ZeroOrderHold(A, nominal.B, period_s);
  const DiscreteModel followed = ZeroOrderHold(Am, reference.B, period_s);
  return {.continuous = RanksOf(A, nominal.B, Am, reference.B),
          .discrete = RanksOf(discrete.A, discrete.B, followed.A, followed.B)};
}

}  // namespace flexarm
