// Every shipped experiment on every shipped rig with the rig's law: what is not refused completes,
// with any payload of 0 to 1 kg.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "config/config.h"
#include "controller/host/run_judge.h"
#include "controller/host/simulation.h"
#include "controller/types/rejected_error.h"
#include "tests/support/campaign.h"

namespace flexarm {
namespace {

constexpr std::array kPayloads_kg = {0.0, 0.1, 0.5, 1.0};
constexpr std::array kSeeds = {1, 2, 3};
// Coprime to the number of cases, so that a sample has every rig, experiment and payload.
constexpr std::size_t kStride = 389;

std::vector<std::filesystem::path> TomlFiles(const std::string& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry :
       std::filesystem::directory_iterator(FLEXARM_SOURCE_DIR "/config/" + folder)) {
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

// As `flexarm simulate` does. Empty: it was refused.
std::optional<SimulationResult> Simulated(const RigConfig& config, const Experiment& experiment,
                                          double payload_kg) {
  try {
    if (PayloadObjection(experiment, config, payload_kg)) return std::nullopt;
    if (RunJudge(config, {}).Judge(experiment, {0.0, 0.0})) return std::nullopt;
    return Simulate({.config = config,
                     .experiment = experiment,
                     .payload_kg = payload_kg,
                     .log = std::nullopt});
  } catch (const RejectedError&) {  // its plan is beyond a limit of this rig
    return std::nullopt;
  }
}

TEST(ShippedRuns, CampaignOfEveryRunThatIsNotRefusedCompletes) {
  const std::vector<std::filesystem::path> rigs = TomlFiles(""), files = TomlFiles("experiments");
  const std::size_t all = rigs.size() * files.size() * kPayloads_kg.size() * kSeeds.size();
  ASSERT_NE(all % kStride, 0u);
  const auto wanted =
      static_cast<std::size_t>(std::max(1L, CampaignCases(48, static_cast<long>(all))));
  std::size_t completed = 0, refused = 0;
  for (std::size_t i = 0; i < std::min(wanted, all); ++i) {
    std::size_t at = i * kStride % all;
    const auto next = [&at](std::size_t size) {
      const std::size_t index = at % size;
      at /= size;
      return index;
    };
    const std::filesystem::path& rig = rigs[next(rigs.size())];
    const std::filesystem::path& file = files[next(files.size())];
    const double payload_kg = kPayloads_kg[next(kPayloads_kg.size())];
    const std::string seed = std::to_string(kSeeds[next(kSeeds.size())]);
    const auto run =
        Simulated(LoadConfig(rig, {"sim.seed=" + seed}), LoadExperiment(file), payload_kg);
    ++(run ? completed : refused);
    if (!run) continue;
    EXPECT_TRUE(run->completed) << "flexarm simulate -c " << rig << " --experiment " << file
                                << " --payload-kg " << payload_kg << " --seed " << seed << ": "
                                << ToString(run->trip);
  }
  EXPECT_GT(completed, 2 * refused);
}

// What was found by running all of them (docs/laws.md).
TEST(ShippedRuns, WhatTripsIsRefusedAndALawThatCompletesItIsNamed) {
  const RigConfig config = LoadConfig(FLEXARM_SOURCE_DIR "/config/hil.toml");
  for (const char* name : {"moves", "tip-positions", "retarget", "fast-moves"}) {
    const Experiment experiment =
        LoadExperiment(FLEXARM_SOURCE_DIR "/config/experiments/" + std::string(name) + ".toml");
    const auto objection = RunJudge(config, WithLaw).Judge(experiment, {0.0, 0.0});
    ASSERT_TRUE(objection) << name;
    EXPECT_NE(objection->remedy.find("\"gain-scheduled\" completes it"), std::string::npos)
        << objection->remedy;
  }
}

}  // namespace
}  // namespace flexarm
