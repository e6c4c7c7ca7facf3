// The prediction of the state to the instant at which a torque acts.

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "model/math/discretize.h"
#include "tests/controller/step/control_step_fixture.h"

namespace flexarm {
namespace {

// The torque of the last step acts in the next one: x_next = A x_hat + B u_before.
TEST_F(ControlStepTest, PredictsToTheInstantAtWhichTheTorqueActs) {
  step_.Step(Moving(0));
  const StepOutput before = step_.Step(Moving(1));
  const StepOutput out = step_.Step(Moving(2));
  const Eigen::VectorXd x = Eigen::Map<const Eigen::VectorXd>(out.x_hat.data(), 12);
  const Eigen::VectorXd expected =
      ShippedDesign().A * x +
      ShippedDesign().B * Eigen::Vector2d(before.torque_nm[0], before.torque_nm[1]);
  const Eigen::VectorXd predicted = Eigen::Map<const Eigen::VectorXd>(out.x_next.data(), 12);
  EXPECT_LT((predicted - expected).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_EQ(out.limits & kPredictionOff, 0u);
}

// Advances x by `ms` under a constant torque: the zero-order hold of that duration in one piece.
Eigen::VectorXd Held(const Eigen::VectorXd& x, double ms, const std::array<double, 2>& torque_nm) {
  const Design& d = ShippedDesign();
  const DiscreteModel hold = ZeroOrderHold(d.A_rate, d.B_rate, 1e-3 * ms);
  return hold.A * x + hold.B * Eigen::Vector2d(torque_nm[0], torque_nm[1]);
}

// Torque k acts 15, 26 or 54 ms after k Ts; until then the earlier ones act in order. Instants are
// rounded to 0.3 us: at rates of 1 rad/s and 100 rad/s^2 the error is 3e-7 rad and 3e-5 rad/s. A
// prediction over one whole period instead has a thousand times that error.
TEST_F(ControlStepTest, PredictsWithTheTorquesThatDoNotActYet) {
  for (const std::int64_t late_ms : {-5, 6, 34}) {
    ControlStep step(config_, ShippedDesign());
    std::vector<StepOutput> out;
    for (StepInput input : ARun()) {
      input.acted_late_ns = input.acts_late_ns = late_ms * 1'000'000;
      out.push_back(step.Step(input));
    }
    const std::size_t k = 30;
    const auto asked = [&out](std::size_t i) { return out[i].torque_nm; };
    Eigen::VectorXd x = Eigen::Map<const Eigen::VectorXd>(out[k].x_hat.data(), 12);
    if (late_ms == -5) {
      x = Held(x, 15, asked(k - 1));
    } else if (late_ms == 6) {
      x = Held(Held(x, 6, asked(k - 2)), 20, asked(k - 1));
    } else {
      x = Held(Held(Held(x, 14, asked(k - 3)), 20, asked(k - 2)), 20, asked(k - 1));
    }
    const Eigen::VectorXd predicted = Eigen::Map<const Eigen::VectorXd>(out[k].x_next.data(), 12);
    EXPECT_LT((predicted - x).head(6).cwiseAbs().maxCoeff(), 3e-7) << late_ms;
    EXPECT_LT((predicted - x).tail(6).cwiseAbs().maxCoeff(), 3e-5) << late_ms;
    EXPECT_NE(asked(k - 1), asked(k - 2)) << "the same torque: the test is inconclusive";
  }
}

// The measured instant is used for the torque that it was measured of, the planned one for the new
// torque.
TEST_F(ControlStepTest, ACommandThatActedLateIsPredictedLate) {
  step_.Step(Moving(0));
  const StepOutput before = step_.Step(Moving(1));
  StepInput input = Moving(2);
  input.acted_late_ns = 3'000'000;
  input.acts_late_ns = 1'000'000;
  const StepOutput out = step_.Step(input);
  ControlStep other(config_, ShippedDesign());
  const StepOutput first = other.Step(Moving(0));
  Eigen::VectorXd x = Eigen::Map<const Eigen::VectorXd>(out.x_hat.data(), 12);
  x = Held(Held(x, 3, first.torque_nm), 18, before.torque_nm);
  const Eigen::VectorXd predicted = Eigen::Map<const Eigen::VectorXd>(out.x_next.data(), 12);
  EXPECT_LT((predicted - x).cwiseAbs().maxCoeff(), 3e-5);
}

TEST_F(ControlStepTest, WithoutPredictionTheLawUsesTheEstimateAndAFlagIsSet) {
  ControlStep step(ShippedRig({kThesisLaw, "controller.prediction=false"}), ShippedDesign());
  step.Step(Moving(0));
  const StepOutput out = step.Step(Moving(1));
  EXPECT_EQ(out.x_next, out.x_hat);
  EXPECT_NE(out.limits & kPredictionOff, 0u);
}

}  // namespace
}  // namespace flexarm
