#include "hal/sim/sim_drift.h"

#include <gtest/gtest.h>

#include "hal/sim/simulated_rig.h"
#include "tests/hal/ideal_sim.h"
#include "tests/hal/thesis_sensors.h"
#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

TEST(SimDrift, WithoutErrorsTheRigIsThatOfTheConfig) {
  const ArmParameters arm = Drifted(ThesisRig(), SimDrift{});
  EXPECT_EQ(arm.payload_mass_kg, ThesisRig().payload_mass_kg);
  EXPECT_EQ(arm.joint[0].coulomb_friction_nm, ThesisRig().joint[0].coulomb_friction_nm);
  EXPECT_EQ(arm.link[1].section[0].youngs_modulus_pa,
            ThesisRig().link[1].section[0].youngs_modulus_pa);
  EXPECT_EQ(Drifted(ThesisSensors(), SimDrift{}).strain[3].gain_v_per_unit, 5000.0);
}

TEST(SimDrift, EachErrorChangesItsOwnPart) {
  SimDrift drift;
  drift.friction_error = {0.5, 0.0};
  drift.joint_stiffness_error = {0.0, -0.1};
  drift.link_stiffness_error = {0.2, 0.0};
  drift.payload_error_kg = 0.05;
  const ArmParameters nominal = ThesisRig(), arm = Drifted(nominal, drift);
  EXPECT_DOUBLE_EQ(arm.joint[0].coulomb_friction_nm, 1.5 * nominal.joint[0].coulomb_friction_nm);
  EXPECT_EQ(arm.joint[1].coulomb_friction_nm, nominal.joint[1].coulomb_friction_nm);
  EXPECT_EQ(arm.joint[0].stiffness_nm_per_rad, nominal.joint[0].stiffness_nm_per_rad);
  EXPECT_DOUBLE_EQ(arm.joint[1].stiffness_nm_per_rad, 0.9 * nominal.joint[1].stiffness_nm_per_rad);
  EXPECT_DOUBLE_EQ(arm.link[0].section[0].bending_stiffness_nm2(),
                   1.2 * nominal.link[0].section[0].bending_stiffness_nm2());
  EXPECT_EQ(arm.link[1].section[0].bending_stiffness_nm2(),
            nominal.link[1].section[0].bending_stiffness_nm2());
  EXPECT_DOUBLE_EQ(arm.payload_mass_kg, nominal.payload_mass_kg + 0.05);
}

TEST(SimDrift, AMissingPayloadLeavesNoNegativeMass) {
  SimDrift drift;
  drift.payload_error_kg = -1.0;
  EXPECT_EQ(Drifted(ThesisRig(), drift).payload_mass_kg, 0.0);
}

// 1 % of the full scale of 2048 counts.
TEST(SimDrift, TheZeroOfAGaugeIsAShareOfTheFullScale) {
  SimDrift drift;
  drift.gauge_zero_share = {0.0, 0.01};
  const SensorConfig sensors = Drifted(ThesisSensors(), drift);
  EXPECT_EQ(sensors.strain[0].offset_counts, 0.0);
  EXPECT_DOUBLE_EQ(sensors.strain[1].offset_counts, 20.48);
  EXPECT_EQ(sensors.strain[19].offset_counts, 0.0);
}

TEST(SimDrift, TheSimulatedRigReadsTheDriftedZero) {
  SimConfig sim = IdealSim(2, 0.5);
  sim.drift.gauge_zero_share = {0.0, 0.01};
  SimulatedRig rig(ThesisRig(), ThesisSensors(0.0), sim);
  const SensorFrame frame = rig.Sample(0);
  EXPECT_EQ(frame.strain[0], 0);
  EXPECT_EQ(frame.strain[1], 20);
}

TEST(SimDrift, ValuesWithoutMeaningAreRefused) {
  SimDrift drift;
  drift.gauge_gain_error = {-1.0};
  ASSERT_EQ(drift.Problems().size(), 1u);
  EXPECT_EQ(drift.Problems()[0].key, "sim.drift.gauge_gain_error[0]");
  drift = {};
  drift.friction_error = {-1.5, 0.0};
  EXPECT_EQ(drift.Problems().size(), 1u);
}

}  // namespace
}  // namespace flexarm
