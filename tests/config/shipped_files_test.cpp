#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "config/config.h"
#include "tests/config/config_testing.h"
#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

TEST(ShippedFiles, EveryRigLoads) {
  int rigs = 0;
  for (const auto& entry : std::filesystem::directory_iterator(Shipped(""))) {
    if (entry.path().extension() != ".toml") continue;
    ++rigs;
    EXPECT_NO_THROW(LoadConfig(entry.path())) << entry.path();
  }
  EXPECT_GE(rigs, 3);
}

TEST(ShippedFiles, EveryExperimentLoads) {
  int experiments = 0;
  for (const auto& entry : std::filesystem::directory_iterator(Shipped("experiments"))) {
    if (entry.path().extension() != ".toml") continue;
    ++experiments;
    EXPECT_NO_THROW({
      const Experiment experiment = LoadExperiment(entry.path());
      EXPECT_EQ(experiment.name, entry.path().stem().string());
      EXPECT_THAT(experiment.text, testing::StartsWith(FileText(entry.path())));
    }) << entry.path();
  }
  EXPECT_GE(experiments, 8);
}

void ExpectSame(const BeamSection& a, const BeamSection& b) {
  EXPECT_EQ(a.length_m, b.length_m);
  EXPECT_EQ(a.area_m2, b.area_m2);
  EXPECT_EQ(a.second_moment_m4, b.second_moment_m4);
  EXPECT_EQ(a.density_kg_m3, b.density_kg_m3);
  EXPECT_EQ(a.youngs_modulus_pa, b.youngs_modulus_pa);
  EXPECT_EQ(a.half_thickness_m, b.half_thickness_m);
}

void ExpectSame(const JointParameters& a, const JointParameters& b) {
  EXPECT_EQ(a.stiffness_nm_per_rad, b.stiffness_nm_per_rad);
  EXPECT_EQ(a.rotor_inertia_kgm2, b.rotor_inertia_kgm2);
  EXPECT_EQ(a.hub_inertia_kgm2, b.hub_inertia_kgm2);
  EXPECT_EQ(a.coulomb_friction_nm, b.coulomb_friction_nm);
  EXPECT_EQ(a.viscous_friction_nm_s_per_rad, b.viscous_friction_nm_s_per_rad);
}

TEST(ShippedFiles, ThesisRigIsTheArmOfTheGoldenNumbers) {
  const ArmParameters arm = LoadConfig(Shipped("thesis-rig.toml")).arm;
  const ArmParameters golden = ThesisRig();
  for (std::size_t i = 0; i < 2; ++i) {
    ASSERT_EQ(arm.link[i].section.size(), 1U);
    ExpectSame(arm.link[i].section[0], golden.link[i].section[0]);
    EXPECT_EQ(arm.link[i].damping_ratio, golden.link[i].damping_ratio);
    ExpectSame(arm.joint[i], golden.joint[i]);
  }
  EXPECT_EQ(arm.hub2_mass_kg, golden.hub2_mass_kg);
  EXPECT_EQ(arm.motor2_mass_kg, golden.motor2_mass_kg);
  EXPECT_EQ(arm.motor2_inertia_kgm2, golden.motor2_inertia_kgm2);
  EXPECT_EQ(arm.payload_mass_kg, golden.payload_mass_kg);
  EXPECT_EQ(arm.payload_inertia_kgm2, golden.payload_inertia_kgm2);
  EXPECT_EQ(arm.shape_payload_mass_kg, golden.shape_payload_mass_kg);
  EXPECT_EQ(arm.damping, golden.damping);
  EXPECT_EQ(arm.link1_tip_inertia, golden.link1_tip_inertia);
  EXPECT_FALSE(arm.foreshortening);
  EXPECT_EQ(arm.joint2_backlash.clearance_rad, 0.0);
}

TEST(ShippedFiles, StiffenedRigDiffersFromTheThesisRigInForeshorteningOnly) {
  std::string stiffened = LoadConfig(Shipped("thesis-rig-stiffened.toml")).text;
  stiffened = Replaced(stiffened, "foreshortening = true", "foreshortening = false");
  stiffened = Replaced(stiffened, "thesis-rig-stiffened", "thesis-rig");
  EXPECT_EQ(stiffened, LoadConfig(Shipped("thesis-rig.toml")).text);
}

TEST(ShippedFiles, PrintedRigDiffersFromTheCorrectedOneInDensityAndModulusOnly) {
  std::string printed = LoadConfig(Shipped("thesis-rig-printed.toml")).text;
  for (int link = 0; link < 2; ++link) {
    printed = Replaced(printed, "density_kg_m3 = 27070.0", "density_kg_m3 = 2707.0");
    printed = Replaced(printed, "youngs_modulus_pa = 6.89e+11", "youngs_modulus_pa = 6.89e+10");
  }
  printed = Replaced(printed, "thesis-rig-printed", "thesis-rig");
  EXPECT_EQ(printed, LoadConfig(Shipped("thesis-rig.toml")).text);
}

TEST(ShippedFiles, HilRigDiffersFromTheThesisRigInItsBackendOnly) {
  const RigConfig rig = LoadConfig(Shipped("thesis-rig.toml"));
  const RigConfig hil = LoadConfig(Shipped("hil.toml"));
  EXPECT_EQ(rig.backend, "");
  EXPECT_EQ(hil.backend, "sim");
  EXPECT_EQ(Replaced(hil.text, "\n[hal]\nbackend = \"sim\"\n", ""), rig.text);
}

TEST(ShippedFiles, ThesisRigHasTheSensorsOfTheThesis) {
  const SensorConfig sensors = LoadConfig(Shipped("thesis-rig.toml")).sensors;
  EXPECT_EQ(sensors.counters_present(), 0b1111U);
  ASSERT_EQ(sensors.encoder.size(), 4U);
  EXPECT_EQ(sensors.encoder[3].counts_per_turn, 24480.0);
  EXPECT_EQ(sensors.encoder[3].counter_bits, 16);
  ASSERT_EQ(sensors.strain.size(), 20U);
  for (std::size_t i = 0; i < 20; ++i) {
    const int link = i < 10 ? 1 : 2;
    const double length = link == 1 ? 0.8 : 0.9;
    EXPECT_EQ(sensors.strain[i].link, link);
    // Decimals of the file compared with a binary product: one rounding.
    EXPECT_NEAR(sensors.strain[i].position_m, (static_cast<double>(i % 10) + 0.5) * length / 10.0,
                1e-15);
  }
  EXPECT_EQ(sensors.strain_input.lowest_count(), -2048);
  EXPECT_EQ(sensors.strain_input.highest_count(), 2047);
  EXPECT_EQ(sensors.strain_input.volts_per_count(), 20.0 / 4096.0);
}

TEST(ShippedFiles, BaseExperimentMovesThirtyDegreesAndBack) {
  const Experiment base = LoadExperiment(Shipped("experiments/square-30deg.toml"));
  EXPECT_EQ(base.duration_s, 6.0);
  ASSERT_EQ(base.doublet.size(), 2U);
  EXPECT_EQ(base.doublet[0].start_s, 0.0);
  EXPECT_EQ(base.doublet[1].start_s, 3.0);
  EXPECT_EQ(base.doublet[0].duration_s, 1.0);
  EXPECT_EQ(base.doublet[0].shape, DoubletShape::kSquare);
  EXPECT_EQ(base.doublet[0].move_deg, (std::array{30.0, 30.0}));
  EXPECT_EQ(base.doublet[1].move_deg, (std::array{-30.0, -30.0}));
  EXPECT_TRUE(base.sim_event.empty());
  EXPECT_EQ(LoadExperiment(Shipped("experiments/sine.toml")).doublet[0].shape, DoubletShape::kSine);
}

}  // namespace
}  // namespace flexarm
