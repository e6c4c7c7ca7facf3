#include "model/perturbation/perturbation_run.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

using Eigen::Vector2d;
using Eigen::VectorXd;

// Figures 6.1 and 6.2: a small square wave added to a moving arm. The linear model neglects terms
// of second order: ten times the perturbation, ten times the relative error (2.3 % measured at the
// smaller one, whose torques are 0.4 % of the nominal ones).
TEST(Perturb, LinearModelAlongAMotionIsCorrectToFirstOrder) {
  ArmParameters p = ThesisRig();
  p.joint[0].coulomb_friction_nm = p.joint[1].coulomb_friction_nm = 0.0;
  p.damping = DampingReading::kNone;
  const ArmModel model(p, {2, 2});
  VectorXd q = VectorXd::Zero(model.dof()), v = q;
  q[kTheta2] = q[kTheta4] = 1.0;
  q[kPhi1] = 0.01;
  q[model.constants().phi2()] = -0.02;
  v[kTheta1] = v[kTheta3] = 1.5;
  v[kTheta2] = v[kTheta4] = -2.5;
  const auto nominal = [](double t) { return Vector2d(t < 0.3 ? 1.0 : -1.0, 0.2); };
  const auto error = [&](double size) {
    const auto delta = [size](double t) { return Vector2d(t < 0.25 ? size : -size, 0.25 * size); };
    const PerturbationRun run = Perturb(model, q, v, nominal, delta, 0.5, 5e-4);
    EXPECT_EQ(run.time_s.size(), 1001u);
    double worst = 0.0;
    for (const Eigen::Index i : {0, 1, 2, 3, 4, 6}) worst = std::fmax(worst, run.RelativeError(i));
    return worst;
  };
  const double small = error(0.004), large = error(0.04);
  EXPECT_LT(small, 0.04);
  EXPECT_NEAR(large / small, 10.0, 3.0);
}

TEST(Perturb, StepAndDurationMustBePositive) {
  const ArmModel model(ThesisRig(), {1, 1});
  const VectorXd rest = VectorXd::Zero(model.dof());
  const auto none = [](double) { return Vector2d(0.0, 0.0); };
  EXPECT_THROW(Perturb(model, rest, rest, none, none, 0.0, 5e-4), std::invalid_argument);
  EXPECT_THROW(Perturb(model, rest, rest, none, none, 1.0, -5e-4), std::invalid_argument);
}

}  // namespace
}  // namespace flexarm
