#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "controller/design/design_controller.h"
#include "controller/reference/reference.h"
#include "controller/step/control_step.h"
#include "model/arm/arm_model.h"
#include "tests/controller/law/shipped_rig.h"
#include "tests/controller/step/step_at_rest.h"

namespace flexarm {
namespace {

// Readings of drives, encoders and gauges of an arm that follows its reference without vibration:
// hub angles and bending of the reference, torque with friction, rotors with the torsion of that
// torque.
StepInput Followed(const ReferenceTable& table, int k, const RigConfig& config) {
  const ArmParameters& arm = config.arm;
  StepInput input = AtRest(k, SafetyState::kRunning);
  input.reset = k == 0 ? 1 : 0;
  const ReferenceSample& now = table.At(k - 1);  // sample k is one period ahead: see `path`
  for (std::size_t i = 0; i < 2; ++i) {
    const double rate_rad_s = now.x_m[6 + i];
    const double friction_nm = arm.joint[i].coulomb_friction_nm * std::tanh(rate_rad_s / 1e-3);
    input.applied_torque_nm[i] = table.At(k - 2).u_m_nm[i] + friction_nm;
    const double rotor_rad =
        now.x_m[i] + input.applied_torque_nm[i] / arm.joint[i].stiffness_nm_per_rad;
    const double counts_per_turn = i == 0 ? 2540.0 : 24480.0;
    const auto hub = std::lround(now.x_m[i] * 2540.0 / (2.0 * M_PI));
    const auto rotor = std::lround(rotor_rad * counts_per_turn / (2.0 * M_PI));
    input.frame.counter[i] = static_cast<std::uint32_t>(hub) & 0xFFu;
    input.frame.counter[2 + i] = static_cast<std::uint32_t>(rotor) & (i == 0 ? 0xFFu : 0xFFFFu);
  }
  const ArmModel model(arm, ModeCount{.link1 = 2, .link2 = 2});
  Eigen::VectorXd q = Eigen::VectorXd::Zero(model.dof());
  q.tail(4) << now.x_m[2], now.x_m[3], now.x_m[4], now.x_m[5];
  for (std::size_t i = 0; i < config.sensors.strain.size(); ++i) {
    const StrainChannelConfig& row = config.sensors.strain[i];
    const double volts = model.Strain(row.link, row.position_m, q) * row.gain_v_per_unit;
    input.frame.strain[i] = static_cast<std::int32_t>(
        std::lround(volts / config.sensors.strain_input.volts_per_count()));
  }
  return input;
}

bool IsMoving(const RigidPoint& point) {
  return point.rate_rad_s[0] != 0.0 || point.rate_rad_s[1] != 0.0;
}

// Two moves of an arm with 0.15 kg, the payload of the scheduled reference. In the first the
// payload is estimated; the second starts with the standard deviation of [estimator.payload], 0.2
// kg, and the random walk of that sample.
TEST(ControlStepWithPayload, AMoveRaisesTheStandardDeviationOfThePayload) {
  const Experiment there_and_back = {
      .name = "test",
      .text = "",
      .duration_s = 6.0,
      .doublet = {},
      .sim_event = {},
      .move = {{.start_s = 0.2, .duration_s = 2.0, .to_deg = {30, -20}},
               {.start_s = 3.0, .duration_s = 2.0, .to_deg = {0, 0}}}};
  const std::array<double, 2> home = {0.0, 0.0};
  const ReferenceTable arm_moves(there_and_back,
                                 DesignController(ShippedRig({"controller.name=gain-scheduled"})),
                                 0.02, home, ShippedLimits());
  for (const char* law : {"gain-scheduled", "sobel"}) {
    SCOPED_TRACE(law);
    const RigConfig config =
        ShippedRig({std::string("controller.name=") + law, "estimator.name=ekf-payload"});
    const Design design = DesignController(config);
    const ReferenceTable table(there_and_back, design, 0.02, home, ShippedLimits());
    ControlStep step(config, design);
    int moves = 0;
    bool moved = false;
    double sigma_before_kg = 0.0;
    for (int k = 0; k <= table.periods(); ++k) {
      StepInput input = Followed(arm_moves, k, config);
      input.path = table.PathAround(k);
      const StepOutput out = step.Step(input);
      if (IsMoving(input.path[1]) && !moved && ++moves == 2) {
        EXPECT_LT(sigma_before_kg, 0.05) << "nothing was estimated: the test is inconclusive";
        const double least_kg = config.estimator.payload->move_sigma_kg;
        EXPECT_GE(out.payload_sigma_kg, least_kg);
        EXPECT_LT(out.payload_sigma_kg, least_kg + 0.001);
      }
      moved = IsMoving(input.path[1]);
      sigma_before_kg = out.payload_sigma_kg;
      EXPECT_EQ(out.payload_warnings, 0u) << k;
    }
    EXPECT_EQ(moves, 2);
    EXPECT_LT(sigma_before_kg, 0.05) << "estimated again";
  }
}

// The arm is at rest, at the plan's state and beside it. Without a plan the path is followed. The
// angles are so small that the bending guard leaves the feedback.
TEST(ControlStepWithPayload, FollowsThePlanIfThereIsOne) {
  const RigConfig config =
      ShippedRig({"controller.name=receding-horizon", "controller.prediction=false"});
  const Design design = DesignController(config);
  const auto asked = [&](const StepInput& at) {
    ControlStep step(config, design);
    StepInput first = AtRest(0, SafetyState::kArmed);
    first.reset = 1;
    static_cast<void>(step.Step(first));
    const StepOutput out = step.Step(at);
    EXPECT_EQ(out.faults, 0u);
    return Eigen::Vector2d(out.torque_nm[0], out.torque_nm[1]);
  };
  StepInput input = AtRest(1, SafetyState::kRunning);
  for (RigidPoint& point : input.path) point.angle_rad[0] = 0.02;
  const Eigen::Matrix<double, 2, 12> K = design.scheduled->gains.At(0.15, 0.0);
  EXPECT_NEAR((asked(input) - K.col(0) * 0.02).norm(), 0.0, 1e-9) << "the torque of the path";
  input.planned = 1;
  input.plan.torque_nm = {0.3, -0.2};
  EXPECT_NEAR((asked(input) - Eigen::Vector2d(0.3, -0.2)).norm(), 0.0, 1e-9);
  input.plan.x[1] = 0.02;
  EXPECT_NEAR((asked(input) - Eigen::Vector2d(0.3, -0.2) - K.col(1) * 0.02).norm(), 0.0, 1e-9);
}

// The arm is at rest 0.01 rad away from a path that rests after a move of one sample: the torque is
// K times 0.01 rad. The filter starts at 0.5 kg with a standard deviation of 0.001 kg, so K is that
// of 0.5 kg until the path has rested for two seconds, and of 0.15 kg from then on. That
// deviation changes the torque by 1e-4 of the difference. Friction is zero, so the law's friction
// compensation is too.
TEST(ControlStepWithPayload, UsesTheRobustGainsAtRest) {
  const RigConfig config =
      ShippedRig({"controller.name=gain-scheduled", "controller.prediction=false",
                  "estimator.payload.start_kg=0.5", "estimator.payload.start_sigma_kg=0.001",
                  "estimator.payload.move_sigma_kg=0.001", "estimator.payload.walk_kg=1e-6",
                  "joint1.coulomb_friction_nm=0", "joint2.coulomb_friction_nm=0"});
  const Design design = DesignController(config);
  ControlStep step(config, design);
  std::vector<StepOutput> out;
  for (int k = 0; k <= 120; ++k) {
    StepInput input = AtRest(k, SafetyState::kRunning);
    input.reset = k == 0 ? 1 : 0;
    for (RigidPoint& point : input.path) point.angle_rad[0] = 0.01;
    if (k == 0) input.path[1].rate_rad_s[0] = 1e-9;
    out.push_back(step.Step(input));
    ASSERT_EQ(out.back().faults, 0u) << k;
  }
  const auto torque = [&design](double payload_kg) -> Eigen::Vector2d {
    return design.scheduled->gains.At(payload_kg, 0.0).col(0) * 0.01;
  };
  const Eigen::Vector2d difference = torque(0.5) - torque(0.15);
  ASSERT_GT(difference.norm(), 1e-3) << "the same gains: the test is inconclusive";
  for (int i = 0; i < 2; ++i) {
    const auto j = static_cast<std::size_t>(i);
    const double tolerance_nm = 2e-4 * difference.norm();
    EXPECT_NEAR(out[90].torque_nm[j], torque(0.5)(i), tolerance_nm);
    EXPECT_NEAR(out[120].torque_nm[j], torque(0.15)(i), tolerance_nm);
  }
}

TEST(ControlStepWithPayload, AMoveWithoutObservabilityWarnsUntilTheNextRun) {
  const RigConfig config = ShippedRig({"controller.name=gain-scheduled"});
  ControlStep step(config, DesignController(config));
  std::uint32_t warnings = 0;
  for (int k = 0; k <= 10; ++k) {
    StepInput input = AtRest(k, SafetyState::kRunning);
    input.reset = k == 0 ? 1 : 0;
    if (k == 5) input.path[1].rate_rad_s[0] = 1e-9;
    warnings = step.Step(input).payload_warnings;
    EXPECT_EQ(warnings, k <= 5 ? 0u : static_cast<std::uint32_t>(kPayloadNotObservable)) << k;
  }
  StepInput again = AtRest(11, SafetyState::kArmed);
  again.reset = 1;
  EXPECT_EQ(step.Step(again).payload_warnings, 0u) << "the warning is of the run before";
}

TEST(ControlStepWithPayload, WithoutAPayloadEstimatorItsOutputsAreNaN) {
  const RigConfig config = ShippedRig({kThesisLaw});
  ControlStep step(config, DesignController(config));
  const StepOutput out = step.Step(AtRest(0, SafetyState::kRunning));
  for (const double value : {out.payload_kg, out.payload_sigma_kg, out.mean_nis, out.friction_nm[0],
                             out.friction_nm[1]}) {
    EXPECT_TRUE(std::isnan(value));
  }
  EXPECT_EQ(out.payload_warnings, 0u);
}

}  // namespace
}  // namespace flexarm
