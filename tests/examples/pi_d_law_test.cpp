// The law of docs/extending.md by itself, and in the control step around the simulated arm.

#include "tests/examples/pi_d_law.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "controller/design/design_controller.h"
#include "controller/law/law_factory.h"
#include "controller/step/control_step.h"
#include "hal/sim/simulated_rig.h"
#include "model/units.h"
#include "tests/controller/law/shipped_rig.h"
#include "tests/controller/step/step_at_rest.h"
#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

// Stiffness and damping of the shipped PD law.
constexpr PiDGains kGains{.stiffness_nm_per_rad = {30.0, 1.0},
                          .integral_nm_per_rad_s = {6.0, 0.2},
                          .damping_nm_s_per_rad = {0.5, 0.3}};
constexpr std::array<double, 2> kLimit_nm = {30.0, 6.0};

struct Situation {
  StateVector x = StateVector::Zero(12);
  ReferenceSample reference{};
  std::array<RigidPoint, 3> path{};

  LawInput input() const {
    return {.x = &x,
            .reference = &reference,
            .path = &path,
            .plan = nullptr,
            .payload = kNoPayloadEstimate,
            .rested_s = 0.0,
            .settling_share = 0.0,
            .may_adapt = true};
  }
};

TEST(PiDLaw, AddsProportionalIntegralAndDerivativeParts) {
  PiDLaw law(kGains, kR12, kPeriod_s, kLimit_nm);
  Situation s;
  s.reference.x_m[0] = 0.1;
  s.x(kR12.rate(kR12.hub(0))) = 0.2;
  EXPECT_NEAR(law.Compute(s.input()).torque_nm[0], 30.0 * 0.1 - 0.5 * 0.2, 1e-12);
  EXPECT_NEAR(law.Compute(s.input()).torque_nm[0], 30.0 * 0.1 - 0.5 * 0.2 + 6.0 * 0.1 * kPeriod_s,
              1e-12);
  law.Reset();
  EXPECT_NEAR(law.Compute(s.input()).torque_nm[0], 30.0 * 0.1 - 0.5 * 0.2, 1e-12);
}

TEST(PiDLaw, TheIntegralIsHeldWhileTheTorqueIsLimited) {
  PiDLaw law(kGains, kR12, kPeriod_s, kLimit_nm);
  Situation far, near;
  far.reference.x_m[0] = 10.0;
  near.reference.x_m[0] = 0.01;
  for (int k = 0; k < 100; ++k) EXPECT_EQ(law.Compute(far.input()).torque_nm[0], 30.0);
  EXPECT_NEAR(law.Compute(near.input()).torque_nm[0], 0.3, 1e-12);
}

// Angles of both hubs after some seconds under a law, deg; the reference is constant from the
// start. Torques act one sample after the step, as on the grid of the loop.
std::array<double, 2> AnglesAfter(double duration_s, std::unique_ptr<Law> law,
                                  const RigConfig& config, const Design& design,
                                  const std::array<double, 2>& target_rad) {
  ControlStep step(config, design, std::move(law));
  SimulatedRig rig(config.arm, config.sensors, config.sim);
  StepOutput out{};
  std::array<double, 2> acting_nm{};
  const int samples = static_cast<int>(duration_s / kPeriod_s);
  for (int k = 0; k < samples; ++k) {
    StepInput input = AtRest(k, SafetyState::kRunning);
    input.reset = k == 0 ? 1 : 0;
    input.frame = rig.Sample(input.sampling_instant_ns);
    input.applied_torque_nm = acting_nm;
    for (int i = 0; i < 2; ++i) {
      const auto joint = static_cast<std::size_t>(i);
      for (const int coordinate : {design.layout.hub(i), design.layout.rotor(i)}) {
        input.reference_next.x_m[static_cast<std::size_t>(coordinate)] = target_rad[joint];
      }
    }
    acting_nm = out.torque_nm;
    out = step.Step(input);
    EXPECT_EQ(out.faults, 0U) << k;
    rig.SetTorque(acting_nm);
    for (std::int64_t t = 0; t < kPeriodNs; t += rig.step_ns()) rig.Step();
  }
  return {rig.truth().hub_angle_rad[0] * kDegPerRad, rig.truth().hub_angle_rad[1] * kDegPerRad};
}

// Friction stops a PD law short of the target: up to 0.16 N m / 30 N m/rad, 0.3 degrees at the
// shoulder. The integral part removes the error.
TEST(PiDLaw, InTheControlStepItReachesTheTargetThatProportionalFeedbackMisses) {
  const RigConfig config = ShippedRig({kThesisLaw});
  const Design design = DesignController(config);
  const std::array<double, 2> target_rad = {0.05, -0.1};
  PiDGains without_integral = kGains;
  without_integral.integral_nm_per_rad_s = {0.0, 0.0};
  const auto angles = [&](const PiDGains& gains) {
    return AnglesAfter(20.0, std::make_unique<PiDLaw>(gains, design.layout, kPeriod_s, kLimit_nm),
                       config, design, target_rad);
  };
  const std::array<double, 2> pd_deg = angles(without_integral), pi_d_deg = angles(kGains);
  const double goal_deg = target_rad[0] * kDegPerRad;
  std::printf("error of the shoulder: PD %.3f deg, PI-D %.3f deg\n", pd_deg[0] - goal_deg,
              pi_d_deg[0] - goal_deg);
  EXPECT_GT(std::fabs(pd_deg[0] - goal_deg), 0.05);
  EXPECT_LT(std::fabs(pi_d_deg[0] - goal_deg), 0.5 * std::fabs(pd_deg[0] - goal_deg));
  EXPECT_NEAR(pi_d_deg[1], target_rad[1] * kDegPerRad, 0.3);
}

}  // namespace
}  // namespace flexarm
