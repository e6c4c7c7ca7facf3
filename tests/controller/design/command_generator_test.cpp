#include "controller/design/command_generator.h"

#include <gtest/gtest.h>

#include "estimator/nominal_model.h"
#include "tests/controller/law/shipped_rig.h"
#include "tests/support/golden_data.h"
#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

using Eigen::MatrixXd;

// Unit modal mass, rates against 42 rad/s: docs/theory/control-law.md 4.3 asks for such a scaling.
Eigen::VectorXd Scale() {
  const NominalModel nominal = MakeNominalModel(ThesisRig(), kR12);
  Eigen::VectorXd scale(12);
  scale.head(6) = nominal.M.diagonal().cwiseSqrt().cwiseInverse();
  scale.tail(6) = 42.0 * scale.head(6);
  return scale;
}

class CommandGeneratorTest : public testing::Test {
 protected:
  MatrixXd Golden(const char* name) const { return AsMatrix(golden_[name]); }

  const nlohmann::json golden_ = GoldenFile("golden.json");
  const TrackingProblem problem_{.A = Golden("R12_A"),
                                 .B = Golden("R12_B"),
                                 .Cp = Golden("R12_K"),
                                 .Am = Golden("R12_Am"),
                                 .Bm = Golden("R12_Bm"),
                                 .Cm = Golden("R12_K"),
                                 .scale = Scale()};
};

// golden.json has a solution of the same equations by Kronecker products. Tolerances: 1e-8 for
// matrices that give states, 1e-6 for those that give torques.
TEST_F(CommandGeneratorTest, OnTheGoldenModelsGivesTheGoldenSolution) {
  const CommandGenerator generator = SolveCommandGenerator(problem_);
  EXPECT_LT(RelativeError(generator.S11, Golden("R12_S11")), 1e-8);
  EXPECT_LT(RelativeError(generator.S12, Golden("R12_S12")), 1e-8);
  EXPECT_LT(RelativeError(generator.S21, Golden("R12_S21")), 1e-6);
  EXPECT_LT(RelativeError(generator.S22, Golden("R12_S22")), 1e-6);
}

// The four equations written out here, in scaled coordinates (z = x / scale).
TEST_F(CommandGeneratorTest, SolvesItsFourEquations) {
  const CommandGenerator g = SolveCommandGenerator(problem_);
  const TrackingProblem& p = problem_;
  const auto to_z = p.scale.cwiseInverse().asDiagonal();
  const auto from_z = p.scale.asDiagonal();
  const MatrixXd state = to_z * (p.A * g.S11 + p.B * g.S21 - g.S11 * p.Am) * from_z;
  const MatrixXd command = to_z * (p.A * g.S12 + p.B * g.S22 - g.S11 * p.Bm - g.S12);
  const MatrixXd output = (p.Cp * g.S11 - p.Cm) * from_z;
  EXPECT_LT(state.cwiseAbs().maxCoeff(), 1e-8);
  EXPECT_LT(command.cwiseAbs().maxCoeff(), 1e-8);
  EXPECT_LT(output.cwiseAbs().maxCoeff(), 1e-8);
  EXPECT_LT((p.Cp * g.S12).cwiseAbs().maxCoeff(), 1e-8);
  EXPECT_LT(TrackingResidual(problem_, g), 1e-8);
}

TEST_F(CommandGeneratorTest, TheResidualDependsOnEachOfTheFourMatrices) {
  const CommandGenerator exact = SolveCommandGenerator(problem_);
  for (int which = 0; which < 4; ++which) {
    CommandGenerator wrong = exact;
    MatrixXd* S =
        std::array{&wrong.S11, &wrong.S12, &wrong.S21, &wrong.S22}[static_cast<std::size_t>(which)];
    *S *= 1.001;
    EXPECT_GT(TrackingResidual(problem_, wrong), 1e-5) << which;
  }
}

// The purpose: a plant that starts on x* and gets u* follows the output of the reference model. 300
// samples of a varying command; A is a double integrator, so errors would grow.
TEST_F(CommandGeneratorTest, APlantOnTheGeneratedTrajectoryFollowsTheOutputExactly) {
  const CommandGenerator g = SolveCommandGenerator(problem_);
  Eigen::VectorXd x_m = Eigen::VectorXd::Zero(12), x = Eigen::VectorXd::Zero(12);
  double worst = 0.0, largest = 0.0;
  Eigen::Vector2d u_m(3.0, 0.4);
  x = g.S11 * x_m + g.S12 * u_m;
  for (int k = 0; k < 300; ++k) {
    const Eigen::VectorXd u = g.S21 * x_m + g.S22 * u_m;
    worst = std::max(worst, (problem_.Cp * x - problem_.Cm * x_m).cwiseAbs().maxCoeff());
    largest = std::max(largest, (problem_.Cm * x_m).cwiseAbs().maxCoeff());
    x = problem_.A * x + problem_.B * u;
    x_m = problem_.Am * x_m + problem_.Bm * u_m;
  }
  EXPECT_GT(largest, 100.0);
  EXPECT_LT(worst, 1e-7 * largest);
}

TEST_F(CommandGeneratorTest, AnInvariantZeroAtOneIsRefused) {
  TrackingProblem problem = problem_;
  // Outputs that are rates only vanish in every constant state of the hubs.
  problem.Cp.setZero();
  problem.Cp(0, 6) = problem.Cp(1, 7) = 1.0;
  EXPECT_THROW(SolveCommandGenerator(problem), std::runtime_error);
}

}  // namespace
}  // namespace flexarm
