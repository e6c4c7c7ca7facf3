// Runs without a fault never trip: arms that differ from the design in noise, backlash, friction
// and payload, with 1 % of the frames lost, under both state estimators.

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <string>

#include "tests/controller/loop/simulated_runs.h"
#include "tests/support/campaign.h"

namespace flexarm {
namespace {

struct CleanRun {
  std::string experiment, law;
  std::uint64_t seed;
  double noise_counts, backlash_rad, payload_kg;
  std::array<double, 2> coulomb_friction_nm;
};

CleanRun Draw(unsigned number) {
  std::mt19937 random(number);
  const auto between = [&random](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const std::array<const char*, 3> experiments = {"square-30deg", "square-20deg", "waypoints"};
  CleanRun run{};
  run.experiment = experiments[random() % experiments.size()];
  // A law that estimates the payload follows moves only.
  run.law = run.experiment == "waypoints" && random() % 2 == 0 ? "gain-scheduled" : "sobel";
  run.seed = number;
  run.noise_counts = between(0.3, 3.0);    // the rig has 1
  run.backlash_rad = between(0.0, 0.003);  // 0.17 deg
  run.payload_kg = between(0.01, 0.2);
  run.coulomb_friction_nm = {0.16 * between(0.5, 1.5), 0.01 * between(0.5, 1.5)};
  return run;
}

SimulationResult Simulated(const CleanRun& run) {
  const std::vector<std::string> common = {"sim.seed=" + std::to_string(run.seed),
                                           "sim.lost_frame_fraction=0.01",
                                           "controller.name=" + run.law};
  std::vector<std::string> plant = common;
  plant.push_back("sensors.strain_input.noise_counts=" + std::to_string(run.noise_counts));
  plant.push_back("joint2.backlash_rad=" + std::to_string(run.backlash_rad));
  for (std::size_t i = 0; i < 2; ++i) {
    plant.push_back("joint" + std::to_string(i + 1) +
                    ".coulomb_friction_nm=" + std::to_string(run.coulomb_friction_nm[i]));
  }
  return Simulate({.config = ShippedRig(common),
                   .experiment = ShippedExperiment(run.experiment),
                   .plant = ShippedRig(plant),
                   .payload_kg = run.payload_kg,
                   .log = {}});
}

TEST(CleanRuns, CampaignNoneTrips) {
  const long runs = CampaignCases(300, 10'000);
  for (long number = 1; number <= runs; ++number) {
    const CleanRun run = Draw(static_cast<unsigned>(number));
    const SimulationResult result = Simulated(run);
    EXPECT_TRUE(result.completed) << "run " << number << ": " << ToString(result.trip) << "; "
                                  << run.experiment << ", " << run.law << ", noise "
                                  << run.noise_counts << " counts, backlash " << run.backlash_rad
                                  << " rad, " << run.payload_kg << " kg, friction "
                                  << run.coulomb_friction_nm[0] << " " << run.coulomb_friction_nm[1]
                                  << " N m";
  }
}

}  // namespace
}  // namespace flexarm
