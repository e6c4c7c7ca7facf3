#include "model/reduction/power_balancing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

#include "model/math/dense_decompositions.h"
#include "model/reduction/arm_reduction.h"
#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Two unit masses, springs k to the wall and c between them; force on the first, output at the
// second. By hand: omega^2 = k and k + 2c, both shapes with input and output weight 1/2.
UndampedSystem TwoMasses(double k, double c) {
  UndampedSystem s{MatrixXd::Identity(2, 2), MatrixXd(2, 2), MatrixXd(2, 1), MatrixXd(1, 2)};
  s.Q2 << k + c, -c, -c, k + c;
  s.B0 << 1.0, 0.0;
  s.C0 << 0.0, 1.0;
  return s;
}

// The same in coordinates that hide the symmetry: z = S z'.
UndampedSystem Skewed(const UndampedSystem& s, const MatrixXd& S) {
  const MatrixXd inverse = S.inverse();
  return {s.Q1, inverse * s.Q2 * S, inverse * s.B0, s.C0 * S};
}

TEST(PowerBalancing, TwoMassesAgreeWithTheClosedForm) {
  const PowerBalance balance = BalancePower(TwoMasses(4.0, 2.5));
  EXPECT_EQ(balance.condition, PowerCondition::kSymmetric);
  ASSERT_EQ(balance.mode.size(), 2u);
  EXPECT_NEAR(balance.mode[0].frequency_rad_s, 2.0, 1e-14);
  EXPECT_NEAR(balance.mode[1].frequency_rad_s, 3.0, 1e-14);
  EXPECT_NEAR(balance.mode[0].rho, 0.5 / 2.0, 1e-14);
  EXPECT_NEAR(balance.mode[1].rho, 0.5 / 3.0, 1e-14);
  // z_i = (sin 2t / 2 +- sin 3t / 3) / 2: twice the mean square is (1/4 + 1/9) / 4; rates 1/2.
  for (const Index i : {0, 1}) {
    EXPECT_NEAR(balance.mu[i], (0.25 + 1.0 / 9.0) / 4.0, 1e-14);
    EXPECT_NEAR(balance.mu_rate[i], 0.5, 1e-14);
  }
}

TEST(PowerBalancing, RelaxedConditionFindsTheSameModesInSkewedCoordinates) {
  MatrixXd S(2, 2);
  S << 1.0, 0.7, -0.2, 30.0;
  const UndampedSystem skewed = Skewed(TwoMasses(4.0, 2.5), S);
  const PowerBalance balance = BalancePower(skewed), plain = BalancePower(TwoMasses(4.0, 2.5));
  EXPECT_EQ(balance.condition, PowerCondition::kDiagonalisable);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_NEAR(balance.mode[k].rho, plain.mode[k].rho, 1e-13);
  }
  // mu of the old coordinates from the modal form of the new ones.
  const MatrixXd old = S * balance.T1;
  for (Index i = 0; i < 2; ++i) {
    double mu = 0.0;
    for (Index k = 0; k < 2; ++k) {
      const PowerMode& mode = balance.mode[static_cast<std::size_t>(k)];
      mu += std::pow(old(i, k) * mode.b_norm / mode.frequency_rad_s, 2);
    }
    EXPECT_NEAR(mu, plain.mu[i], 1e-13);
  }
}

// The definition (6.17) by stepping the impulse responses. Over 2000 s the cross terms have decayed
// to (difference of frequencies * time)^-1 = 5e-4.
TEST(PowerBalancing, PowerElementsAreTimeAverages) {
  MatrixXd S(2, 2);
  S << 1.0, 0.7, -0.2, 3.0;
  for (const UndampedSystem& s : {TwoMasses(4.0, 2.5), Skewed(TwoMasses(4.0, 2.5), S)}) {
    const PowerBalance balance = BalancePower(s);
    const VectorXd average = TimeAveragedPower(s, 2000.0, 0.01);
    for (Index i = 0; i < 2; ++i) {
      EXPECT_NEAR(average[i] / balance.mu[i], 1.0, 2e-3);
      EXPECT_NEAR(average[2 + i] / balance.mu_rate[i], 1.0, 2e-3);
    }
  }
}

UndampedSystem RandomUndamped(unsigned seed, bool symmetric) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  const Index n = 2 + static_cast<Index>(seed % 6);
  const auto matrix = [&](Index rows, Index cols) {
    MatrixXd out(rows, cols);
    for (double& x : out.reshaped()) x = normal(engine);
    return out;
  };
  const MatrixXd W = matrix(n, n), V = matrix(n, n), one = MatrixXd::Identity(n, n);
  UndampedSystem s{one, W * W.transpose() + one, matrix(n, 2), matrix(3, n)};
  if (symmetric) {
    s.Q1 = V * V.transpose() + one;
  } else {
    s = Skewed(s, V);
  }
  return s;
}

// Appendix D's statement, without its proof: L transforms the system to the balanced one, and the
// mean of twice eta eta' over the impulse responses is diag(rho) from the input's side and from the
// output's. The means are exact: by the modal form, not by time.
TEST(PowerBalancing, TransformedSystemIsInternallyPowerBalanced) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const UndampedSystem s = RandomUndamped(seed, seed % 2 == 0);
    const PowerBalance balance = BalancePower(s);
    EXPECT_EQ(balance.condition,
              seed % 2 == 0 ? PowerCondition::kSymmetric : PowerCondition::kDiagonalisable);
    const auto modes = static_cast<int>(balance.mode.size());
    const PowerBalancedSystem eta = Realize(balance, modes);
    const Index n = s.Q1.rows();
    ASSERT_EQ(modes, n) << "seed " << seed;
    MatrixXd A = MatrixXd::Zero(2 * n, 2 * n), B = MatrixXd::Zero(2 * n, 2);
    A.topRightCorner(n, n) = s.Q1;
    A.bottomLeftCorner(n, n) = -s.Q2;
    B.bottomRows(n) = s.B0;
    const double size = A.cwiseAbs().maxCoeff() * eta.L.cwiseAbs().maxCoeff();
    EXPECT_LT((A * eta.L - eta.L * eta.A).cwiseAbs().maxCoeff(), 1e-10 * size) << "seed " << seed;
    EXPECT_LT((B - eta.L * eta.B).cwiseAbs().maxCoeff(), 1e-10 * size) << "seed " << seed;
    EXPECT_LT((s.C0 * eta.L.topRows(n) - eta.C).cwiseAbs().maxCoeff(), 1e-10 * size);
    for (Index k = 0; k < n; ++k) {  // twice the mean squares of (b/r) sin, (b/r) cos, c r
      const double reached = eta.B.row(2 * k + 1).squaredNorm();
      const double seen = eta.C.col(2 * k).squaredNorm();
      EXPECT_NEAR(reached / seen, 1.0, 1e-9) << "seed " << seed;
      const double before = k > 0 ? eta.B.row(2 * k - 1).squaredNorm() : reached;
      EXPECT_LE(reached, before) << "largest first";
    }
    // (6.22): the power elements of z from those of eta.
    VectorXd rho(2 * n);
    for (Index k = 0; k < n; ++k) rho[2 * k] = rho[2 * k + 1] = eta.B.row(2 * k + 1).squaredNorm();
    const VectorXd mu = eta.L.cwiseAbs2() * rho;
    EXPECT_LT((mu.head(n) - balance.mu).norm(), 1e-9 * mu.norm());
    EXPECT_LT((mu.tail(n) - balance.mu_rate).norm(), 1e-9 * mu.norm());
  }
}

TEST(PowerBalancing, RigidAndGrowingRootsAreDroppedByName) {
  UndampedSystem s{MatrixXd::Identity(3, 3), MatrixXd::Zero(3, 3), MatrixXd::Ones(3, 1),
                   MatrixXd::Ones(1, 3)};
  s.Q2.diagonal() << 9.0, -4.0, 1e-9;
  const PowerBalance balance = BalancePower(s);
  ASSERT_EQ(balance.mode.size(), 1u);
  EXPECT_NEAR(balance.mode[0].frequency_rad_s, 3.0, 1e-14);
  ASSERT_EQ(balance.dropped.size(), 2u);
  EXPECT_EQ(balance.dropped[0].reason, DroppedRoot::Reason::kNegative);
  EXPECT_EQ(balance.dropped[1].reason, DroppedRoot::Reason::kRigid);
  s.Q2 << 1.0, 5.0, 0.0, -5.0, 1.0, 0.0, 0.0, 0.0, 16.0;
  const PowerBalance fluttering = BalancePower(s);
  ASSERT_EQ(fluttering.dropped.size(), 2u);
  EXPECT_EQ(fluttering.dropped[0].reason, DroppedRoot::Reason::kComplex);
}

TEST(PowerBalancing, SystemsThatCannotBeBalancedAreRejected) {
  EXPECT_THROW(BalancePower(TwoMasses(4.0, 0.0)), std::domain_error) << "equal roots";
  UndampedSystem neither = TwoMasses(4.0, 2.5);
  neither.Q1(0, 1) = 0.5;
  EXPECT_THROW(BalancePower(neither), std::invalid_argument);
  UndampedSystem sizes = TwoMasses(4.0, 2.5);
  sizes.B0 = MatrixXd::Ones(3, 1);
  EXPECT_THROW(BalancePower(sizes), std::invalid_argument);
  UndampedSystem bad = TwoMasses(4.0, 2.5);
  bad.Q2(0, 0) = std::nan("");
  EXPECT_THROW(BalancePower(bad), std::invalid_argument);
  const PowerBalance balance = BalancePower(TwoMasses(4.0, 2.5));
  EXPECT_THROW(Realize(balance, 0), std::invalid_argument);
  EXPECT_THROW(Realize(balance, 3), std::invalid_argument);
  UndampedSystem unseen = TwoMasses(4.0, 2.5);
  unseen.C0 << 0.0, 0.0;
  EXPECT_THROW(Realize(BalancePower(unseen), 1), std::domain_error);
}

ArmModel ReferenceArm() {
  ArmParameters p = ThesisRig();
  p.link1_tip_inertia = Link1TipInertia::kMotor;  // the basis of docs/theory/plant.md 8.2
  return ArmModel(p, {10, 10});
}

NominalMotion Motion(double theta2_deg, double rate1, double rate2) {
  return {theta2_deg * M_PI / 180.0, rate1, rate2};
}

struct TableRow {
  NominalMotion motion;
  ModalScaling scaling;
  double link1[2], link2[2];  // eps_1, eps_2, percent
};

// docs/theory/plant.md 8.2, M = 10: printed with two decimals.
TEST(ArmReduction, ContributionsAgreeWithTheReference) {
  const TableRow rows[] = {
      {Motion(0, 0, 0), ModalScaling::kMass, {99.50, 99.99}, {99.23, 99.99}},
      {Motion(0, 0, 0), ModalScaling::kLength, {95.37, 99.44}, {98.18, 99.98}},
      {Motion(45, -1, 3), ModalScaling::kMass, {99.52, 99.99}, {99.30, 99.99}},
      {Motion(90, -4, -6), ModalScaling::kMass, {99.76, 99.99}, {99.84, 100.0}},
      {Motion(90, 0, 0), ModalScaling::kMass, {99.478, 99.99}, {99.35, 99.99}}};
  const ArmModel arm = ReferenceArm();
  for (const TableRow& row : rows) {
    const ArmReduction reduction = ReduceArm(arm, row.motion, row.scaling);
    for (Index k = 0; k < 2; ++k) {
      EXPECT_NEAR(reduction.link[0].epsilon_percent[k], row.link1[k], 0.00501) << k;
      EXPECT_NEAR(reduction.link[1].epsilon_percent[k], row.link2[k], 0.00501) << k;
    }
    EXPECT_DOUBLE_EQ(reduction.link[0].epsilon_percent[9], 100.0);
  }
  // "At rest link 1 falls 99.505 -> 99.478."
  const double straight =
      ReduceArm(arm, Motion(0, 0, 0), ModalScaling::kMass).link[0].epsilon_percent[0];
  EXPECT_NEAR(straight, 99.505, 5e-4);
}

// At rest: two zeros. In motion the elbow's zero becomes a small positive root that would be 93 %
// of the sum of rho (docs/theory/plant.md 8.1). Beyond 90 degrees it turns negative.
TEST(ArmReduction, RigidBodyRootsAreFoundAndMarked) {
  const ArmModel arm = ReferenceArm();
  const auto at = [&](const NominalMotion& motion) {
    return ReduceArm(arm, motion, ModalScaling::kMass).balance;
  };
  const PowerBalance rest = at(Motion(0, 0, 0)), moving = at(Motion(45, -1, 3));
  EXPECT_EQ(rest.dropped.size(), 2u);
  EXPECT_FALSE(rest.mode[0].rigid_origin);
  EXPECT_EQ(moving.dropped.size(), 1u);
  ASSERT_TRUE(moving.mode[0].rigid_origin);
  EXPECT_FALSE(moving.mode[1].rigid_origin);
  double sum = 0.0;
  for (const PowerMode& mode : moving.mode) sum += mode.rho;
  EXPECT_NEAR(moving.mode[0].rho / sum, 0.93, 0.005);
  const PowerBalance folded = at(Motion(120, -4, -6));
  ASSERT_EQ(folded.dropped.size(), 2u);
  EXPECT_EQ(folded.dropped[0].reason, DroppedRoot::Reason::kNegative);
}

TEST(ArmReduction, BothConditionsAgreeOnTheArmAtRest) {
  const ArmModel arm = ReferenceArm();
  const PowerBalance relaxed = BalancePower(UndampedArm(arm, Motion(30, 0, 0)));
  const PowerBalance symmetric = BalancePower(UndampedArmAtRest(arm, M_PI / 6.0));
  EXPECT_EQ(relaxed.condition, PowerCondition::kDiagonalisable);
  EXPECT_EQ(symmetric.condition, PowerCondition::kSymmetric);
  ASSERT_EQ(relaxed.mode.size(), 22u);
  ASSERT_EQ(symmetric.mode.size(), 22u);
  for (std::size_t k = 0; k < 22; ++k) {
    EXPECT_NEAR(relaxed.mode[k].rho / symmetric.mode[k].rho, 1.0, 1e-5) << k;
  }
  for (Index i = 0; i < 24; ++i) EXPECT_NEAR(relaxed.mu[i] / symmetric.mu[i], 1.0, 1e-6) << i;
}

// docs/theory/plant.md 8.2: 60 s of the impulse response give the same mu to 0.07 %. Measured:
// 0.0750 % for link 2's second mode (slow beat of the roots at 16.7 and 17.4 Hz), at most 0.023 %
// for the others; a step of 2e-5 s changes nothing. The rigid motions grow in the angles only, so
// the modal coordinates can be compared directly.
TEST(ArmReduction, SixtySecondsOfImpulseResponseGiveTheSamePowerElements) {
  const ArmModel arm = ReferenceArm();
  const UndampedSystem system = UndampedArm(arm, Motion(0, 0, 0));
  const VectorXd average = TimeAveragedPower(system, 60.0, 1e-3 / M_PI);
  const PowerBalance balance = BalancePower(system);
  for (Index i = kPhi1; i < arm.dof(); ++i) {
    EXPECT_NEAR(average[i] / balance.mu[i], 1.0, 7.6e-4) << "coordinate " << i;
  }
}

TEST(ArmReduction, ContributionsDoNotDependOnTheOutput) {
  const ArmModel arm = ReferenceArm();
  UndampedSystem system = UndampedArm(arm, Motion(45, -1, 3));
  const VectorXd mu = BalancePower(system).mu;
  system.C0 = MatrixXd::Ones(1, arm.dof());
  EXPECT_EQ(BalancePower(system).mu, mu);
}

}  // namespace
}  // namespace flexarm
