#include "model/beam_methods/exact_arm.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

#include "model/arm/arm_model.h"
#include "model/arm/linearization.h"
#include "tests/model/arm/fe_arm.h"
#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

constexpr double kRightAngle_rad = M_PI / 2.0;

void ExpectClose(const std::vector<double>& found, const std::vector<double>& expected,
                 double relative) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_NEAR(found[i] / expected[i], 1.0, relative) << "frequency " << i + 1;
  }
}

// A program in Python with 100 Hermite elements a link, written from the energies for this test
// alone. Its error grows with the fourth power of the frequency, to 3e-7 for the tenth; round-off
// adds 5e-6 to the lowest with held motors, whose stiffness is the smallest (fewer elements have
// less: 16 give 0.69114863 Hz).
TEST(ExactArm, HasTheFrequenciesOfAnIndependentFiniteElementModel) {
  const ArmParameters p = ThesisRig();
  ExpectClose(ExactArm(p, 0.0).FrequenciesHz(10, false),
              {6.620644654, 8.758385371, 16.674348003, 17.35428847, 39.946856088, 46.893035699,
               94.918764329, 97.915722567, 160.776249806, 189.688954222},
              1e-6);
  ExpectClose(ExactArm(p, kRightAngle_rad).FrequenciesHz(10, false),
              {6.620507625, 8.757020205, 16.677549721, 17.256506, 39.931131336, 46.770404379,
               94.809496905, 97.87587923, 160.654572322, 189.659641351},
              1e-6);
  ExpectClose(ExactArm(p, 0.0).FrequenciesHz(10, true),
              {0.691148441, 2.063219333, 10.103993846, 16.516769586, 36.571178973, 46.575129287,
               94.778464417, 96.727490886, 160.694419669, 189.145518221},
              1e-5);
  ExpectClose(ExactArm(p, kRightAngle_rad).FrequenciesHz(10, true),
              {0.75678493, 1.832913337, 10.050446903, 16.412940786, 36.528906053, 46.469085609,
               94.622931406, 96.731746089, 160.571081343, 189.117202697},
              1e-5);
}

TEST(ExactArm, HasTheFrequenciesOfFiniteElementsForSteppedLinksAndOtherPayloads) {
  ArmParameters p = ThesisRig();
  BeamSection root = p.link[0].section[0], end = root;
  root.length_m = 0.15, root.second_moment_m4 *= 4.0, root.area_m2 *= 1.6;
  end.length_m = 0.65;
  p.link[0].section = {root, end};
  p.payload_mass_kg = 0.7;
  p.payload_inertia_kgm2 = 2e-3;
  const Eigen::VectorXd fe = FeArm(p, 0.8, 30).FreeFrequenciesHz();
  const std::vector<double> exact = ExactArm(p, 0.8).FrequenciesHz(8, false);
  for (int i = 0; i < 8; ++i) {
    EXPECT_NEAR(exact[static_cast<std::size_t>(i)] / fe[i], 1.0, 2e-5) << i;
  }
}

// Rayleigh and Ritz: every frequency of assumed modes is above its exact one, and falls with the
// number of modes.
TEST(ExactArm, IsApproachedFromAboveByAssumedModes) {
  const ArmParameters p = ThesisRig();
  const std::vector<double> exact = ExactArm(p, 0.6).FrequenciesHz(6, false);
  double above = 1e300;
  for (const int modes : {2, 4, 6, 10}) {
    const Eigen::VectorXd assumed = FreeMotorFrequenciesHz(ArmModel(p, {modes, modes}), 0.6);
    double worst = 0.0;
    for (int i = 0; i < 6; ++i) {
      const double error = assumed[i] / exact[static_cast<std::size_t>(i)] - 1.0;
      EXPECT_GT(error, -1e-9) << modes << " modes, " << i;
      worst = std::max(worst, error);
    }
    EXPECT_LT(worst, above);
    above = worst;
  }
  EXPECT_LT(above, 1e-5);
}

TEST(ExactArm, CountsTheRigidBodyZerosOfFreeMotors) {
  const ExactArm arm(ThesisRig(), 0.3);
  EXPECT_EQ(arm.CountBelow(0.1, false), 2);
  EXPECT_EQ(arm.CountBelow(0.1, true), 0);
}

TEST(ExactArm, RefusesParametersWithProblems) {
  ArmParameters p = ThesisRig();
  p.joint[1].stiffness_nm_per_rad = 0.0;
  EXPECT_THROW(ExactArm(p, 0.0), std::invalid_argument);
}

}  // namespace
}  // namespace flexarm
