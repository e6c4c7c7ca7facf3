// Shipped commands on the thesis's arm, where they stay as they are, and on others.

#include "config/fitted_experiment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "config/thesis_arm.h"
#include "controller/types/tip_tolerance.h"
#include "tests/config/config_testing.h"

namespace flexarm {
namespace {

constexpr double kRoundOff = 1e-9;

constexpr std::array<const char*, 6> kCommands = {
    "benchmark-square", "benchmark-sine", "benchmark-waypoints",
    "benchmark-unseen", "moves",          "square-30deg"};

Experiment Command(const std::string& name) {
  return LoadExperiment(Shipped("experiments/" + name + ".toml"));
}

TEST(FitExperiment, LeavesTheCommandsOfTheThesisRigAsTheyAre) {
  for (const char* name : kCommands) {
    const FittedExperiment fitted = FitExperiment(Command(name), HilWith({}));
    EXPECT_EQ(fitted.how, "") << name;
    EXPECT_EQ(fitted.experiment.text, Command(name).text);
  }
}

TEST(FitExperiment, KeepsTwoThirdsOfTheSoftAngles) {
  // The square turns by 30 degrees: 20 are two thirds of 30.
  const FittedExperiment fitted =
      FitExperiment(Command("square-30deg"), HilWith({"limits.soft_angle_deg=[90, 30]"}));
  EXPECT_EQ(fitted.how, "0.67 times as far");
  ASSERT_EQ(fitted.experiment.doublet.size(), 2U);
  for (const double angle_deg : fitted.experiment.doublet[0].move_deg) {
    EXPECT_NEAR(angle_deg, 20.0, kRoundOff);
  }
  EXPECT_EQ(fitted.experiment.doublet[0].duration_s, 1.0);
}

TEST(FitExperiment, TakesLongerWhereTheTorqueIsSmall) {
  const RigConfig weak = HilWith({"limits.torque_limit_nm=[2, 6]"});
  const Experiment before = Command("square-30deg");
  const FittedExperiment fitted = FitExperiment(before, weak);
  EXPECT_THAT(fitted.how, testing::HasSubstr("times as long"));
  const double stretch = fitted.experiment.duration_s / before.duration_s;
  EXPECT_GT(stretch, 1.0);
  // Each time is rounded up to one or two periods of 20 ms.
  EXPECT_NEAR(fitted.experiment.doublet[1].start_s, 3.0 * stretch, 0.04);
  EXPECT_NEAR(fitted.experiment.doublet[1].duration_s, stretch, 0.04);
  // A quarter of the torque needs twice the time: the torque falls with the time's square.
  const FittedExperiment weaker =
      FitExperiment(before, HilWith({"limits.torque_limit_nm=[0.5, 6]"}));
  EXPECT_NEAR(weaker.experiment.duration_s / fitted.experiment.duration_s, 2.0, 0.02);
}

TEST(FitExperiment, PutsTimesOnSamples) {
  // 8 ms: a doublet of 1 s has no even number of them, 1.008 s has.
  const RigConfig rig =
      HilWith({"loop.period_ms=8", "loop.acquire_before_ms=4", "loop.step_deadline_ms=2",
               "loop.output_after_ms=6", "safety.permit_timeout_ms=5"});
  const FittedExperiment fitted = FitExperiment(Command("square-30deg"), rig);
  EXPECT_EQ(fitted.how, "on samples of 8 ms");
  EXPECT_NEAR(fitted.experiment.doublet[0].duration_s, 1.008, kRoundOff);
  EXPECT_EQ(fitted.experiment.doublet[1].start_s, 3.0);
}

TEST(FitExperiment, HasThePayloadsOfTheRig) {
  const FittedExperiment heavy =
      FitExperiment(Command("moves"), HilWith({"controller.payload_range_kg=[0.5, 3]"}));
  EXPECT_EQ(heavy.experiment.payload_kg, (std::array{0.5, 3.0}));
  const FittedExperiment within =
      FitExperiment(Command("moves"), HilWith({"controller.payload_range_kg=[0.1, 0.2]"}));
  EXPECT_EQ(within.how, "");
}

TEST(FitExperiment, LeavesOtherRowsAlone) {
  const Experiment chirp = Command("chirp");
  const FittedExperiment fitted =
      FitExperiment(chirp, HilWith({"limits.soft_angle_deg=[0.5, 0.5]"}));
  EXPECT_EQ(fitted.experiment.text, chirp.text);
}

TEST(ThesisArm, IsEveryConfigOfThatArmAndNoOther) {
  for (const char* name : {"thesis-rig", "hil", "half-bridges", "daq-rig", "thesis-rig-printed",
                           "thesis-rig-stiffened"}) {
    EXPECT_EQ(DiffersFromThesisArm(LoadConfig(Shipped(std::string(name) + ".toml")).arm), "")
        << name;
  }
  EXPECT_FALSE(IsThesisArm(LoadConfig(Shipped("quanser-2dsfl.toml")).arm));
  EXPECT_TRUE(IsThesisArm(HilWith({"arm.payload_mass_kg=0.3", "rig.name=mine"}).arm));
  ArmParameters longer = HilWith({}).arm;
  longer.link[1].section[0].length_m = 0.95;
  EXPECT_THAT(DiffersFromThesisArm(longer), testing::HasSubstr("link 2 is 0.95 m long"));
  EXPECT_THAT(DiffersFromThesisArm(HilWith({"link1.section[0].area_m2=2e-4"}).arm),
              testing::HasSubstr("link 1 has another cross section"));
  EXPECT_THAT(DiffersFromThesisArm(HilWith({"arm.motor2_mass_kg=1.0"}).arm),
              testing::HasSubstr("1.24 kg"));
}

TEST(SettledWithin, IsOnePercentOfTheReachAndACountAtMost15Millimetres) {
  // 1 % of 1.7 m would be 17 mm.
  EXPECT_EQ(SettledWithin_m(HilWith({})), 0.015);
  RigConfig small = HilWith({"sensors.encoder[1].counts_per_turn=2000"});
  small.arm.link[0].section[0].length_m = 0.4;
  small.arm.link[1].section[0].length_m = 0.3;
  // One count of the coarser hub encoder: 2 pi / 2000 at 0.7 m.
  EXPECT_NEAR(SettledWithin_m(small), 0.007 + 2.0 * M_PI / 2000.0 * 0.7, 1e-12);
}

}  // namespace
}  // namespace flexarm
