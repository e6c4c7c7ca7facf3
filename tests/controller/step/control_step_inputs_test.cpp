// Frames, strains and numbers that are missing, late or not finite.

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <string>

#include "controller/design/design_controller.h"
#include "controller/types/trip_cause.h"
#include "tests/controller/step/control_step_fixture.h"

namespace flexarm {
namespace {

// One missing frame is bridged by prediction; more than two periods without a frame are a fault.
TEST_F(ControlStepTest, AFrameOfAnotherTickIsIgnored) {
  step_.Step(AtRest(0, SafetyState::kRunning));
  StepInput late = AtRest(1, SafetyState::kRunning);
  late.frame.sampled_at_ns = 0;
  late.frame.counter[0] = 20;  // must have no effect
  const StepOutput out = step_.Step(late);
  EXPECT_EQ(out.counters_used, 0u);
  EXPECT_EQ(out.strain_used, 0u);
  EXPECT_EQ(out.counts[0], 0);
  EXPECT_EQ(out.faults, 0u);
  EXPECT_NE(out.limits & kAdaptationHeld, 0u);
  const StepOutput next = step_.Step(AtRest(2, SafetyState::kRunning));
  EXPECT_EQ(next.counters_used, 0b1111u);
  EXPECT_EQ(next.faults, 0u);
}

TEST_F(ControlStepTest, AStaleFrameIsAFaultAndZeroesTheTorque) {
  StepOutput out{};
  for (int k = 0; k <= 3; ++k) {
    StepInput input = Moving(k);
    input.frame.sampled_at_ns = 0;
    out = step_.Step(input);
  }
  EXPECT_NE(out.faults & CauseBit(TripCause::kStaleFrame), 0u);
  EXPECT_NE(out.faults & CauseBit(TripCause::kNoCounterReading), 0u);
  EXPECT_EQ(out.torque_nm, (std::array<double, 2>{0.0, 0.0}));
}

// Gauges that answer without a good reading: one sample is bridged, the second has no torque and
// the name of the link, whatever the estimator.
TEST_F(ControlStepTest, LostStrainIsAFaultOfItsLinkInTheSecondSample) {
  struct Case {
    std::uint32_t valid;
    TripCauses faults;
  };
  constexpr TripCauses kLink1 = CauseBit(TripCause::kNoStrainReading1),
                       kLink2 = CauseBit(TripCause::kNoStrainReading2);
  for (const char* estimator : {"estimator.name=kalman", "estimator.name=difference",
                                "estimator.name=polynomial", "controller.name=gain-scheduled"}) {
    const RigConfig config = ShippedRig({estimator});
    const Design design = DesignController(config);
    for (const Case& lost : {Case{0xFFC00, kLink1}, Case{0x003FF, kLink2}, Case{0, kLink1 | kLink2},
                             Case{0xFFC03, kLink1}}) {  // two gauges do not check each other
      SCOPED_TRACE(std::string(estimator) + " " + std::to_string(lost.valid));
      ControlStep step(config, design);
      StepInput input = Moving(0);
      input.reset = 1;
      step.Step(input);
      for (int k = 1; k <= 3; ++k) {
        input = Moving(k);
        for (RigidPoint& point : input.path) point.angle_rad[0] = 0.01;  // of the scheduled law
        input.frame.strain_valid = lost.valid;
        const StepOutput out = step.Step(input);
        EXPECT_EQ(out.faults, k < 2 ? 0 : lost.faults) << k;
        EXPECT_EQ(out.torque_nm[0] != 0.0, k < 2) << k;
        EXPECT_EQ(std::isnan(out.root_strain[0]), (lost.faults & kLink1) != 0) << "unknown";
        EXPECT_EQ(std::isnan(out.root_strain[1]), (lost.faults & kLink2) != 0) << "unknown";
        EXPECT_EQ(out.may_damp, 0);
        if (k == 2) {
          EXPECT_EQ(out.fault_value, lost.valid == 0xFFC03 ? 2.0 : 0.0) << "good gauges";
          EXPECT_EQ(out.fault_limit, 3.0) << "gauges that it takes";
        }
        for (const double x : out.x_hat) EXPECT_TRUE(std::isfinite(x));
      }
      EXPECT_EQ(step.Step(AtRest(4, SafetyState::kTripped)).faults, 0u) << "the readings are back";
    }
  }
}

TEST_F(ControlStepTest, SomeGaugesMayBeMissing) {
  ControlStep whole(config_, ShippedDesign());
  for (int k = 0; k < 20; ++k) {
    StepInput input = Moving(k);
    const StepOutput all = whole.Step(input);
    input.frame.strain_valid = 0xFFFFF & ~(1U << 3 | 1U << 7 | 1U << 15);
    const StepOutput out = step_.Step(input);
    EXPECT_EQ(out.faults, 0u);
    EXPECT_EQ(out.strain_used, input.frame.strain_valid);
    EXPECT_NEAR(out.torque_nm[0], all.torque_nm[0], 1e-9) << "zero strain by any gauges";
  }
}

TEST_F(ControlStepTest, AnAppliedTorqueThatIsNaNIsAFaultAndZeroesTheTorque) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    ControlStep step(config_, ShippedDesign());
    step.Step(Moving(0));
    StepInput poisoned = Moving(1);
    poisoned.applied_torque_nm[1] = bad;
    const StepOutput out = step.Step(poisoned);
    EXPECT_NE(out.faults & CauseBit(TripCause::kStateNotFinite), 0u);
    EXPECT_EQ(out.torque_nm, (std::array<double, 2>{0.0, 0.0}));
  }
}

// Clipping alone would turn a NaN into full torque: fmax and fmin ignore it.
TEST_F(ControlStepTest, AReferenceThatIsNaNIsAFaultAndZeroesTheTorque) {
  step_.Step(AtRest(0, SafetyState::kArmed));
  StepInput input = Moving(1);
  input.reference_next.x_m[0] = std::numeric_limits<double>::quiet_NaN();
  const StepOutput output = step_.Step(input);
  EXPECT_EQ(output.faults, CauseBit(TripCause::kStateNotFinite));
  EXPECT_EQ(output.torque_nm, (std::array<double, 2>{0.0, 0.0}));
  EXPECT_EQ(step_.Step(Moving(2)).faults, 0u) << "the adaptive gains must not contain it";
}

// A trip can be reset only when its cause is gone, and the step is reset only when the arm is armed
// again. So a state that is not finite must recover without a reset, or the daemon stays tripped.
TEST_F(ControlStepTest, AStateThatWasNotFiniteRecoversWithTheInputs) {
  step_.Step(Moving(0));
  StepInput poisoned = Moving(1);
  poisoned.applied_torque_nm[0] = std::numeric_limits<double>::quiet_NaN();
  step_.Step(poisoned);
  StepOutput out{};
  for (int k = 2; k < 40; ++k) out = step_.Step(AtRest(k, SafetyState::kTripped));
  EXPECT_EQ(out.faults, 0u);
  EXPECT_TRUE(out.at_rest);
}

}  // namespace
}  // namespace flexarm
