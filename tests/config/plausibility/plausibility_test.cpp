#include "config/plausibility/plausibility.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "config/config_place.h"
#include "config/plausibility/plausibility_rules.h"
#include "tests/config/config_testing.h"

namespace flexarm {
namespace {

using testing::ElementsAre;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> KeysOf(const ImplausibleValueList& found) {
  std::vector<std::string> keys;
  for (const ImplausibleValue& value : found) keys.push_back(value.key);
  return keys;
}

// The keys that `rule` finds in the shipped arm with one change.
template <typename Rule>
std::vector<std::string> Found(const Rule& rule, const std::vector<std::string>& overrides) {
  return KeysOf(rule(HilWith(overrides)));
}

TEST(Plausibility, ShippedRigsGiveNoWarningButTheMisprintedTable) {
  int rigs = 0;
  for (const auto& entry : std::filesystem::directory_iterator(Shipped(""))) {
    if (entry.path().extension() != ".toml") continue;
    ++rigs;
    const std::vector<std::string> keys = KeysOf(ImplausibleValues(LoadConfig(entry.path())));
    if (entry.path().filename() == "thesis-rig-printed.toml") {
      EXPECT_THAT(
          keys, ElementsAre("link1.section[0].youngs_modulus_pa", "link1.section[0].density_kg_m3",
                            "link2.section[0].youngs_modulus_pa", "link2.section[0].density_kg_m3",
                            "loop.period_ms"));
    } else {
      EXPECT_THAT(keys, IsEmpty()) << entry.path();
    }
  }
  EXPECT_GE(rigs, 7);
}

TEST(Plausibility, AModulusInGigapascalIsFoundWithValueRangeAndUnit) {
  const ImplausibleValueList found =
      ImplausibleValues(HilWith({"link1.section[0].youngs_modulus_pa=207"}));
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found[0].key, "link1.section[0].youngs_modulus_pa");
  EXPECT_EQ(found[0].value, "207");
  EXPECT_THAT(found[0].unusual, HasSubstr("unusually small, perhaps meant in GPa"));
  EXPECT_THAT(found[0].usual, HasSubstr("1e+09 to 5e+11"));
}

TEST(Plausibility, MaterialsOfAllKindsPass) {
  for (const char* modulus : {"2e9", "6.9e10", "2.07e11", "4.1e11"}) {
    EXPECT_THAT(
        Found(JudgeMaterials, {std::string("link1.section[0].youngs_modulus_pa=") + modulus}),
        IsEmpty())
        << modulus;
  }
  for (const char* density : {"900.0", "2700.0", "19300.0"}) {
    EXPECT_THAT(Found(JudgeMaterials, {std::string("link2.section[0].density_kg_m3=") + density}),
                IsEmpty())
        << density;
  }
}

TEST(Plausibility, AWrongMaterialIsFound) {
  EXPECT_THAT(Found(JudgeMaterials, {"link2.section[0].youngs_modulus_pa=2.07e12"}),
              ElementsAre("link2.section[0].youngs_modulus_pa"));
  EXPECT_THAT(Found(JudgeMaterials, {"link1.section[0].density_kg_m3=2.707"}),
              ElementsAre("link1.section[0].density_kg_m3"));
  EXPECT_THAT(Found(JudgeMaterials, {"link1.section[0].density_kg_m3=400.0"}),
              ElementsAre("link1.section[0].density_kg_m3"));
}

TEST(Plausibility, ALengthInMillimetresIsFound) {
  EXPECT_THAT(Found(JudgeLinkLengths, {"link1.section[0].length_m=800.0"}),
              ElementsAre("link1.section[0].length_m"));
  EXPECT_THAT(Found(JudgeLinkLengths, {"link1.section[0].length_m=5.0"}), IsEmpty());
  RigConfig stepped = LoadConfig(Shipped("quanser-2dsfl.toml"));
  EXPECT_THAT(JudgeLinkLengths(stepped), IsEmpty());
  stepped.arm.link[1].section[0].length_m = 79.0;
  EXPECT_THAT(KeysOf(JudgeLinkLengths(stepped)), ElementsAre("link2.section"));
}

TEST(Plausibility, ASecondMomentThatDoesNotGoWithAreaAndThicknessIsFound) {
  // 35.0 x 4.5 mm: a rectangle's, 2.658e-10.
  const std::string key = "link1.section[0].second_moment_m4=";
  EXPECT_THAT(Found(JudgeThickness, {key + "2.657e-7"}),
              ElementsAre("link1.section[0].half_thickness_m"));
  EXPECT_THAT(Found(JudgeThickness, {key + "1.3e-10"}),
              ElementsAre("link1.section[0].half_thickness_m"));
  EXPECT_THAT(Found(JudgeThickness, {key + "5.2e-10"}), IsEmpty()) << "within a factor of 2";
  EXPECT_THAT(Found(JudgeThickness, {"link1.section[0].half_thickness_m=0.0045"}),
              ElementsAre("link1.section[0].half_thickness_m"))
      << "the thickness for its half";
  const ImplausibleValueList found = JudgeThickness(HilWith({key + "2.657e-7"}));
  EXPECT_THAT(found[0].unusual, HasSubstr("1e+03 times"));
  EXPECT_THAT(found[0].usual, HasSubstr("second_moment_m4 2.66e-10"));
}

TEST(Plausibility, ARigidPartMayHaveAnyThicknessUnlessAGaugeIsOnIt) {
  RigConfig config = LoadConfig(Shipped("quanser-2dsfl.toml"));
  EXPECT_THAT(JudgeThickness(config), IsEmpty());
  config.sensors.strain[0].position_m = 0.05;  // on the hub's block
  EXPECT_THAT(KeysOf(JudgeThickness(config)), ElementsAre("link1.section[0].half_thickness_m"));
}

TEST(Plausibility, ASectionWithoutCrossSectionHasNoMaterialToJudge) {
  RigConfig config = HilWith({});
  BeamSection& section = config.arm.link[0].section[0];
  section.given_bending_stiffness_nm2 = section.bending_stiffness_nm2();
  section.given_mass_per_length_kg_m = section.mass_per_length_kg_m();
  section.area_m2 = section.second_moment_m4 = section.density_kg_m3 = 0.0;
  section.youngs_modulus_pa = 0.0;
  section.has_cross_section = false;
  EXPECT_THAT(ImplausibleValues(config), IsEmpty());
}

TEST(Plausibility, DampingInPerCentIsFound) {
  EXPECT_THAT(Found(JudgeDamping, {"link2.damping_ratio=0.5"}), ElementsAre("link2.damping_ratio"));
  EXPECT_THAT(Found(JudgeDamping, {"link2.damping_ratio=0.2"}), IsEmpty());
  EXPECT_THAT(Found(JudgeDamping, {"link2.damping_ratio=0.5", "arm.damping=none"}), IsEmpty())
      << "not used";
}

TEST(Plausibility, AJointThatTheTorqueTwistsFarIsFound) {
  EXPECT_THAT(Found(JudgeJointTwist, {"joint1.stiffness_nm_per_rad=13.3"}),
              ElementsAre("joint1.stiffness_nm_per_rad"));
  EXPECT_THAT(Found(JudgeJointTwist, {"joint1.stiffness_nm_per_rad=200.0"}), IsEmpty());
}

TEST(Plausibility, AnEncoderOfFewCountsIsFound) {
  EXPECT_THAT(Found(JudgeEncoders, {"sensors.encoder[0].counts_per_turn=500"}),
              ElementsAre("sensors.encoder[0].counts_per_turn"));
  EXPECT_THAT(Found(JudgeEncoders, {"sensors.encoder[0].counts_per_turn=700"}), IsEmpty());
  // The elbow turns 0.9 m of 1.7: 333 counts a turn move the tip by 1 %.
  EXPECT_THAT(Found(JudgeEncoders, {"sensors.encoder[1].counts_per_turn=500"}), IsEmpty());
  EXPECT_THAT(Found(JudgeEncoders, {"sensors.encoder[3].counts_per_turn=300"}),
              ElementsAre("sensors.encoder[3].counts_per_turn"));
}

// As numbers, because other rules refuse such a gauge with the noise of the shipped rig.
TEST(Plausibility, AGaugeThatABentLinkMovesByFewCountsIsFound) {
  const RigConfig shipped = HilWith({});
  RigConfig weak = shipped;
  weak.sensors.strain[2].gain_v_per_unit = 5.0;
  const ImplausibleValueList found = JudgeGaugeSignals(weak);
  ASSERT_THAT(KeysOf(found), ElementsAre("sensors.strain[2].gain_v_per_unit"));
  EXPECT_THAT(found[0].unusual, HasSubstr("1 % of the link, 8 mm"));
  RigConfig enough = shipped;
  enough.sensors.strain[2].gain_v_per_unit = 500.0;
  EXPECT_THAT(JudgeGaugeSignals(enough), IsEmpty());
  RigConfig coarse = shipped;
  coarse.sensors.strain_input.converter_bits = 3;
  EXPECT_EQ(JudgeGaugeSignals(coarse).size(), 20U) << "every gauge of a coarse converter";
}

TEST(Plausibility, GaugesTooCloseToSeparateTwoModesAreFound) {
  RigConfig config = HilWith({});
  StrainChannelConfig near = config.sensors.strain[0];
  near.position_m += 0.004;
  const StrainChannelConfig far = config.sensors.strain[5];
  const auto with = [&](const StrainChannelConfig& second) {
    RigConfig changed = config;
    changed.sensors.strain.erase(changed.sensors.strain.begin(),
                                 changed.sensors.strain.begin() + 10);
    changed.sensors.strain.insert(changed.sensors.strain.begin(),
                                  {config.sensors.strain[0], second});
    return changed;
  };
  const ImplausibleValueList found = JudgeGaugePlaces(with(near));
  ASSERT_THAT(KeysOf(found), ElementsAre("sensors.strain[1].position_m"));
  EXPECT_THAT(found[0].unusual, HasSubstr("the gauges of link 1"));
  EXPECT_THAT(JudgeGaugePlaces(with(far)), IsEmpty());
  RigConfig one_mode = with(near);
  one_mode.estimator.modes_per_link = 1;
  EXPECT_THAT(JudgeGaugePlaces(one_mode), IsEmpty()) << "nothing to separate";
}

TEST(Plausibility, ModesOfTheNominalModelAboveHalfTheSamplingRateAreFound) {
  RigConfig config = HilWith({});
  config.loop.period_ms = 40.0;
  const ImplausibleValueList found = JudgeSamplingRate(config);
  ASSERT_THAT(KeysOf(found), ElementsAre("loop.period_ms"));
  EXPECT_THAT(found[0].unusual, HasSubstr("12.5 Hz"));
  EXPECT_THAT(Found(JudgeSamplingRate, {}), IsEmpty());
}

TEST(Plausibility, ATorqueLimitThatFrictionTakesIsFound) {
  EXPECT_THAT(Found(JudgeFrictionTorques, {"joint2.coulomb_friction_nm=4.0"}),
              ElementsAre("limits.torque_limit_nm[1]"));
  EXPECT_THAT(Found(JudgeFrictionTorques, {"joint2.coulomb_friction_nm=2.0"}), IsEmpty());
}

TEST(Plausibility, ATorqueLimitThatBendsTheLinkFarBeyondItsStrainIsFound) {
  // Link 2: E I = 5.51 N m^2 bends to 1.9e-3 at a surface 1.5875 mm away with 6.6 N m.
  const ImplausibleValueList found =
      JudgeBendingTorques(HilWith({"limits.torque_limit_nm=[30.0, 70.0]"}));
  ASSERT_THAT(KeysOf(found), ElementsAre("limits.torque_limit_nm[1]"));
  EXPECT_THAT(found[0].unusual, HasSubstr("6.6 N m bend link 2"));
  EXPECT_THAT(Found(JudgeBendingTorques, {"limits.torque_limit_nm=[30.0, 60.0]"}), IsEmpty());
}

TEST(Plausibility, AStrainLimitOutsideOfMetalsIsFound) {
  RigConfig config = HilWith({});
  config.safety.strain_limit = {8e-3, 2e-5};
  EXPECT_THAT(KeysOf(JudgeStrainLimits(config)),
              ElementsAre("limits.strain_limit[0]", "limits.strain_limit[1]"));
  config.safety.strain_limit = {4e-3, 1e-4};
  EXPECT_THAT(JudgeStrainLimits(config), IsEmpty());
}

TEST(Plausibility, AValueIsPlacedInTheFileThatHoldsIt) {
  const std::vector<std::string> keys = {"link1.section[0].youngs_modulus_pa",
                                         "link1.damping_ratio", "hal.backend", "no.such_key"};
  const std::vector<ConfigPlace> places =
      PlacesOf(Shipped("hil.toml"), {"link1.damping_ratio=0.5"}, keys);
  ASSERT_EQ(places.size(), keys.size());
  EXPECT_EQ(places[0].file, Shipped("thesis-rig.toml"));
  EXPECT_EQ(places[0].line, LineOf(FileText(Shipped("thesis-rig.toml")), "youngs_modulus_pa"));
  EXPECT_EQ(places[1].file, "--set");
  EXPECT_EQ(places[1].line, 0);
  EXPECT_EQ(places[2].file, Shipped("hil.toml"));
  EXPECT_EQ(places[3].file, Shipped("hil.toml"));
  EXPECT_EQ(places[3].line, 0);
}

}  // namespace
}  // namespace flexarm
