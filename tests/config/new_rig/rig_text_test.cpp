#include "config/new_rig/rig_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "tests/config/config_testing.h"
#include "tests/config/new_rig/steel_arm.h"

namespace flexarm {
namespace {

using testing::HasSubstr;

ArmDescription SteelArm(std::vector<std::string> values = {}) {
  const TempFolder folder;
  return ArmDescriptionReader(folder.Write("arm.toml", kSteelArm), std::move(values)).Read();
}

TEST(NewRig, HasTheArmThatItsOwnerDescribed) {
  const RigConfig rig = NewRig(SteelArm());
  const BeamSection& section = rig.arm.link[0].section.front();
  EXPECT_NEAR(section.area_m2, 25e-3 * 2e-3, 1e-12);
  // w h^3 / 12, to the six digits of the text.
  EXPECT_NEAR(section.second_moment_m4, 25e-3 * 8e-9 / 12.0, 1e-16);
  EXPECT_EQ(section.half_thickness_m, 1e-3);
  EXPECT_EQ(rig.arm.motor2_mass_kg, 1.2);
  EXPECT_EQ(rig.arm.payload_mass_kg, 0.3);
  EXPECT_EQ(rig.controller.payload_range_kg, (std::array{0.0, 0.6}));
  EXPECT_EQ(rig.loop.period_ms, 20.0);
  EXPECT_EQ(rig.sensors.counters_present(), 0b0011U) << "it has no encoders on the rotors";
  EXPECT_EQ(rig.sensors.strain.size(), 2U);
  EXPECT_EQ(rig.backend, "sim");
}

TEST(NewRig, HasRotorEncodersBehindTheirGears) {
  const RigConfig rig = NewRig(
      SteelArm({"joint1.gear=50", "joint2.gear=100", "joint1.rotor_encoder_counts_per_turn=2000",
                "joint2.rotor_encoder_counts_per_turn=1000", "joint1.motor_inertia_kgm2=2e-6"}));
  ASSERT_EQ(rig.sensors.encoder.size(), 4U);
  EXPECT_EQ(rig.sensors.encoder[2].counts_per_turn, 1e5);
  EXPECT_EQ(rig.sensors.encoder[3].counts_per_turn, 1e5);
  EXPECT_NEAR(rig.arm.joint[0].rotor_inertia_kgm2, 2e-6 * 2500.0, 1e-9);
}

TEST(NewRig, TakesMassAndStiffnessInPlaceOfTheMaterial) {
  const RigConfig rig =
      NewRig(SteelArm({"link1.mass_per_length_kg_m=0.5", "link1.bending_stiffness_nm2=4"}));
  const BeamSection& section = rig.arm.link[0].section.front();
  EXPECT_FALSE(section.has_cross_section);
  EXPECT_EQ(section.mass_per_length_kg_m(), 0.5);
  EXPECT_EQ(section.bending_stiffness_nm2(), 4.0);
  EXPECT_EQ(section.half_thickness_m, 1e-3);
}

TEST(NewRig, RoundsThePeriodToTheGridOfTheSafetyTask) {
  EXPECT_EQ(NewRig(SteelArm({"rate_hz=300"})).loop.period_ms, 3.5);
  EXPECT_EQ(NewRig(SteelArm({"rate_hz=500"})).loop.period_ms, 2.0);
}

TEST(NewRig, SaysWhereEachDerivedOrTunedValueComesFrom) {
  const std::string text =
      NewRigText(SteelArm(), {{"estimator.payload.walk_kg", "0.5"}, {"controller.alpha", "2"}});
  EXPECT_THAT(text, HasSubstr("walk_kg = 0.5  # tuned; derived: 0.00165\n"));
  EXPECT_THAT(text, HasSubstr("alpha = 2  # tuned; derived: 1.5\n"));
  EXPECT_THAT(text, HasSubstr("max_kg = 0.66  # derived: 1.1 times the greatest payload\n"));
  std::istringstream lines(text);
  int sources = 0;
  for (std::string line; std::getline(lines, line);) {
    if (line.find("# derived: ") != std::string::npos) ++sources;
  }
  EXPECT_GT(sources, 40);
}

TEST(NewRig, IsReadBackToTheSameConfig) {
  const std::string text = NewRigText(SteelArm());
  EXPECT_EQ(ParseConfig(text, "rig.toml").text, NewRig(SteelArm()).text);
}

}  // namespace
}  // namespace flexarm
