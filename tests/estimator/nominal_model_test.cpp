// The nominal models by name, against golden.json and docs/theory/control-law.md 1.2.

#include "estimator/nominal_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <vector>

#include "model/math/dense_decompositions.h"
#include "model/math/discretize.h"
#include "tests/support/golden_data.h"
#include "tests/support/loop_time.h"
#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

using Eigen::MatrixXd;

struct Mode {
  double hz, zeta;
};

// Oscillating modes of x' = A x, ascending.
std::vector<Mode> ModesOf(const NominalModel& model) {
  const Eigen::VectorXcd roots = model.A.eigenvalues();
  std::vector<Mode> modes;
  for (const std::complex<double>& s : roots) {
    if (s.imag() > 1.0) {
      modes.push_back({std::abs(s) / (2.0 * std::numbers::pi), -s.real() / std::abs(s)});
    }
  }
  std::sort(modes.begin(), modes.end(), [](const Mode& a, const Mode& b) { return a.hz < b.hz; });
  return modes;
}

class Layout : public testing::TestWithParam<NamedLayout> {};
INSTANTIATE_TEST_SUITE_P(NominalModels, Layout, testing::ValuesIn(kNominalModels),
                         [](const auto& shown) { return std::string(shown.param.name); });

TEST_P(Layout, IsNamedByItsJointsAndItsStates) {
  const auto& [name, layout] = GetParam();
  EXPECT_EQ(name.substr(0, 1), layout.torsion ? "T" : "R");
  EXPECT_EQ(name.substr(1), std::to_string(layout.states()));
  EXPECT_EQ(NameOf(layout), name);
  EXPECT_EQ(LayoutNamed(name), layout);
}

TEST_P(Layout, GivesEveryStateADistinctMeaning) {
  const StateLayout layout = GetParam().layout;
  std::multiset<int> coordinates;
  for (int i = 0; i < 2; ++i) {
    coordinates.insert(layout.hub(i));
    if (layout.torsion) coordinates.insert(layout.rotor(i));
    for (int j = 0; j < layout.modes_per_link; ++j) coordinates.insert(layout.mode(i, j));
  }
  std::multiset<int> states = coordinates, all;
  for (const int coordinate : coordinates) states.insert(layout.rate(coordinate));
  for (int i = 0; i < layout.states(); ++i) all.insert(i);
  EXPECT_EQ(states, all);
}

TEST_P(Layout, HasTheSameRigidInertiaAsAnyOther) {
  // docs/theory/control-law.md 2.2: M_r = [[2.864, 0.308], [0.308, 0.1529]] kg m^2 (four digits).
  const Eigen::Matrix2d M_r = MakeNominalModel(ThesisRig(), GetParam().layout).RigidInertia_kgm2();
  EXPECT_NEAR(M_r(0, 0), 2.864, 5e-4);
  EXPECT_NEAR(M_r(0, 1), 0.308, 5e-4);
  EXPECT_NEAR(M_r(1, 0), 0.308, 5e-4);
  EXPECT_NEAR(M_r(1, 1), 0.1529, 5e-5);
}

// With joints a million times as stiff the torsional models equal the rigid ones: their lowest
// torque modes agree up to the remaining compliance, 1e-6 of a few, and the torque acts alike.
TEST(TorsionalModels, WithStiffJointsEqualTheRigidOnes) {
  ArmParameters stiff = ThesisRig();
  for (JointParameters& joint : stiff.joint) joint.stiffness_nm_per_rad *= 1e6;
  for (const auto& [torsional, rigid] : {std::pair{kT12, kR8}, std::pair{kT16, kR12}}) {
    const Eigen::VectorXd with = MakeNominalModel(stiff, torsional).torque_mode_rad_s;
    const Eigen::VectorXd without = MakeNominalModel(stiff, rigid).torque_mode_rad_s;
    ASSERT_EQ(with.size(), without.size() + 2);
    for (Eigen::Index i = 0; i < without.size(); ++i) {
      EXPECT_NEAR(with(i), without(i), 1e-5 * without(i)) << NameOf(torsional) << " mode " << i;
    }
  }
}

// docs/theory/control-law.md 1.2, table of torque-mode frequencies (damping ratio), three digits
// each.
TEST(NominalModels, HaveTheFrequenciesAndDampingsOfTheStudy) {
  const auto t12 = ModesOf(MakeNominalModel(ThesisRig(), kT12));
  ASSERT_EQ(t12.size(), 4u);
  const std::vector<Mode> expected = {{6.76, 0.11}, {9.76, 0.09}, {68.2, 0.02}, {77.5, 0.03}};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(t12[i].hz, expected[i].hz, 6e-4 * expected[i].hz + 5e-3) << i;
    EXPECT_NEAR(t12[i].zeta, expected[i].zeta, 5e-3) << i;
  }
  const auto t16 = ModesOf(MakeNominalModel(ThesisRig(), kT16));
  ASSERT_EQ(t16.size(), 6u);
  const std::vector<double> hz = {6.63, 8.79, 16.8, 17.5, 119, 191};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(t16[i].hz, hz[i], 5e-3 * hz[i]) << i;
  EXPECT_NEAR(t16[2].zeta, 0.14, 5e-3);
  EXPECT_NEAR(t16[3].zeta, 0.27, 5e-3);
}

class T12Golden : public testing::Test {
 protected:
  const nlohmann::json golden_ = GoldenFile("golden.json");
  const NominalModel nominal_ = MakeNominalModel(ThesisRig(), kT12);
};

TEST_F(T12Golden, DiscreteModelAgrees) {
  const DiscreteModel discrete = ZeroOrderHold(nominal_.A, nominal_.B, kPeriod_s);
  EXPECT_LT(RelativeError(nominal_.M, AsMatrix(golden_["M_T12_zero"])), 1e-8);
  EXPECT_LT(RelativeError(discrete.A, AsMatrix(golden_["T12_A"])), 1e-8);
  EXPECT_LT(RelativeError(discrete.B, AsMatrix(golden_["T12_B"])), 1e-8);
}

TEST_F(T12Golden, ReferenceModelAgrees) {
  const NominalModel reference = MakeReferenceModel(nominal_);
  const DiscreteModel discrete = ZeroOrderHold(reference.A, reference.B, kPeriod_s);
  EXPECT_LT(RelativeError(discrete.A, AsMatrix(golden_["T12_Am"])), 1e-6);
  EXPECT_LT(RelativeError(discrete.B, AsMatrix(golden_["T12_Bm"])), 1e-6);
}

}  // namespace
}  // namespace flexarm
