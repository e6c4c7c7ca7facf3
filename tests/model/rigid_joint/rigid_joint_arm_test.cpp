// The small model of the loop against the off-line one, and against another program's numbers.

#include "model/rigid_joint/rigid_joint_arm.h"

#include <gtest/gtest.h>

#include <random>

#include "model/arm/arm_model.h"
#include "model/math/library_math.h"
#include "tests/support/golden_data.h"
#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Vector = RigidJointArm::Vector;

static_assert(noexcept(std::declval<const RigidJointArm&>().Outboard(0.1)));

ArmParameters RigWith(double payload_kg) {
  ArmParameters p = ThesisRig();
  p.payload_mass_kg = payload_kg;
  p.payload_inertia_kgm2 = 2e-4;  // large enough to have an effect
  return p;
}

// [th1 th2 f..] to [th1 th2 th3 th4 f..].
MatrixXd RigidJoints() {
  MatrixXd T_r = MatrixXd::Zero(8, 6);
  T_r(0, 0) = T_r(1, 1) = T_r(2, 0) = T_r(3, 1) = 1.0;
  T_r.bottomRows(4).rightCols(4).setIdentity();
  return T_r;
}

// Uniform within +-size.
Vector Random(std::mt19937* random, const Vector& size) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Vector out;
  for (double& entry : out) entry = unit(*random);
  return out.cwiseProduct(size);
}

// Measured: 1.1e-15, round-off. Rotor 2 missing in the body on hub 2 gives 0.8.
template <typename Math>
void ExpectTheReducedModel() {
  const MatrixXd T_r = RigidJoints();
  std::mt19937 random(7);
  const Vector q_size = {3.0, 3.0, 0.2, 2e-3, 0.1, 1e-3};
  const Vector v_size = {8.0, 10.0, 2.0, 0.05, 2.0, 0.05};
  for (const double payload_kg : {0.0, 0.1, 0.37, 1.0}) {
    const ArmModel full(RigWith(payload_kg), {2, 2});
    const RigidJointArm arm(RigWith(0.2));  // its own payload has no effect
    for (int i = 0; i < 50; ++i) {
      const Vector q = Random(&random, q_size), v = Random(&random, v_size);
      const auto terms = arm.At<Math>(arm.Outboard(payload_kg), q, v);
      const VectorXd Q = T_r * q, V = T_r * v;
      EXPECT_LT(RelativeError(terms.M, T_r.transpose() * full.MassMatrix(Q) * T_r), 1e-12);
      EXPECT_LT(RelativeError(terms.bias, T_r.transpose() * full.Bias(Q, V)), 1e-12);
      EXPECT_EQ(terms.M(5, 0), terms.M(0, 5));
    }
    EXPECT_EQ(arm.stiffness(), T_r.transpose() * full.stiffness() * T_r);
    EXPECT_EQ(arm.damping(), T_r.transpose() * full.damping() * T_r);
  }
}

TEST(RigidJointArm, EqualsTheArmModelWithRigidJoints) {
  ExpectTheReducedModel<PortableMath>();
  ExpectTheReducedModel<LibraryMath>();
}

TEST(RigidJointArm, AgreesWithTheGoldenMassMatrixAndBias) {
  const auto golden = GoldenFile("beyond-golden.json");
  const RigidJointArm arm(ThesisRig());
  const Vector q = AsVector(golden["q"]), v = AsVector(golden["v"]);
  const auto terms = arm.At(arm.Outboard(golden["m"]), q, v);
  EXPECT_LT(RelativeError(terms.M, AsMatrix(golden["M"])), 1e-8);
  EXPECT_LT(RelativeError(terms.bias, AsVector(golden["bias"])), 1e-8);
}

TEST(RigidJointArm, RejectsInvalidParameters) {
  ArmParameters p = ThesisRig();
  p.link[1].section.clear();
  EXPECT_THROW(RigidJointArm{p}, std::invalid_argument);
}

}  // namespace
}  // namespace flexarm
