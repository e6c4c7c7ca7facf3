#include "tools/bench_host/solver_problem.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

SolverProblem Problem() { return {ThesisRig(), {30.0, 6.0}}; }

// Against the mass matrix and the bias of ArmModel, which share no code with the fast solver.
// Rounding: 1e-16 of terms of 1e4 rad/s^2 times the condition of the mass matrix, some 1e5.
TEST(PlantRate, IsTheAccelerationOfTheModel) {
  const SolverProblem problem = Problem();
  PlantRate rate(problem.model());
  const Eigen::Vector2d push = problem.PushBefore(0);
  rate.Push(push);
  const Eigen::VectorXd force = problem.model().InputMatrix() * push;
  for (const SolverProblem::State& y : problem.ByPlant(5e-4)) {
    SolverProblem::State y_dot{};
    rate(y.data(), y_dot.data());
    const Eigen::VectorXd q = Eigen::VectorXd::Map(y.data(), PlantRate::kDof);
    const Eigen::VectorXd v = Eigen::VectorXd::Map(y.data() + PlantRate::kDof, PlantRate::kDof);
    const Eigen::VectorXd a = problem.model().Acceleration(q, v, force);
    const auto found = Eigen::VectorXd::Map(y_dot.data() + PlantRate::kDof, PlantRate::kDof);
    EXPECT_EQ(v, Eigen::VectorXd::Map(y_dot.data(), PlantRate::kDof));
    EXPECT_LT((found - a).cwiseAbs().maxCoeff(), 1e-9 * a.cwiseAbs().maxCoeff());
  }
}

// CVODE tries states far away, and goes back.
TEST(PlantRate, OneStateDoesNotChangeTheNext) {
  const SolverProblem problem = Problem();
  PlantRate rate(problem.model());
  const SolverProblem::State y = problem.ByPlant(5e-4)[3];
  SolverProblem::State broken = y, first{}, between{}, second{};
  broken[kPhi1] = std::nan("");
  rate(y.data(), first.data());
  rate(broken.data(), between.data());
  rate(y.data(), second.data());
  EXPECT_TRUE(std::isnan(between.back()));
  EXPECT_EQ(first, second);
}

TEST(PlantRate, RefusesOtherNumbersOfModes) {
  EXPECT_THROW(PlantRate(ArmModel(SmoothArm(ThesisRig()), {4, 3})), std::invalid_argument);
}

// Second order: half the step has about a quarter of the error, 4.5 times less as measured (31.7 um
// at 0.5 ms), because the fastest mode decays within a step. Order 1 gives 2, order 3 gives 8.
// The reference is a thousand times as accurate, so its own error does not matter.
TEST(SolverProblem, ThePlantConvergesToTheReferenceInSecondOrder) {
  const SolverProblem problem = Problem();
  const SolverReference reference = MakeReference(problem);
  const double whole_m = problem.TipError_m(problem.ByPlant(5e-4), reference.motion);
  const double half_m = problem.TipError_m(problem.ByPlant(2.5e-4), reference.motion);
  EXPECT_EQ(std::lround(std::log2(whole_m / half_m)), 2);
  EXPECT_LT(reference.error_m, 1e-3 * half_m);
}

TEST(SolverProblem, TheArmTurnsAndItsPushChangesInTheMiddle) {
  const SolverProblem problem = Problem();
  EXPECT_GT(std::fabs(problem.ByPlant(5e-4).back()[kTheta1]), 0.2);
  EXPECT_EQ(problem.PushBefore(9), problem.PushBefore(0));
  EXPECT_EQ(problem.PushBefore(10), Eigen::Vector2d(-problem.PushBefore(0)));
}

TEST(SolverProblem, AMotionThatIsNotFiniteHasNoSmallError) {
  const SolverProblem problem = Problem();
  const SolverProblem::Motion motion = problem.ByPlant(5e-4);
  SolverProblem::Motion broken = motion;
  broken[3][0] = std::nan("");
  EXPECT_FALSE(problem.TipError_m(motion, broken) <= 1.0);
  EXPECT_EQ(problem.TipError_m(motion, motion), 0.0);
}

}  // namespace
}  // namespace flexarm
