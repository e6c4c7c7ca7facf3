#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>

#include "config/new_rig/arm_description.h"
#include "controller/host/simulation.h"
#include "tests/config/config_testing.h"
#include "tests/config/new_rig/steel_arm.h"
#include "tools/sweep/fast_moves.h"
#include "tools/tuning/design_score.h"
#include "tools/tuning/move_check.h"
#include "tools/tuning/new_rig_search.h"

namespace flexarm {
namespace {

struct Arm {
  const char* name;
  double most_over_bound;  ///< of later fast moves
  int most_trips;          ///< of eight runs of fast moves
  std::string text;
};

std::ostream& operator<<(std::ostream& out, const Arm& arm) { return out << arm.name; }

// Lengths 0.25 to 1.5 m, aluminium and steel, tip 0.05 to 2 kg, one to ten gauges a link, encoders
// of 2,000 to 400,000 counts, with and without encoders on the rotors, 50 to 500 Hz.
const std::array<Arm, 5> kArms = {{
    {"SteelOfTheReview", 1.6, 0, kSteelArm},
    {"SmallAndFast", 1.6, 0, R"(material = "aluminium"
link1 = {length_m = 0.25, width_mm = 20, thickness_mm = 1.5}
link2 = {length_m = 0.25, width_mm = 20, thickness_mm = 1.2}
joint1 = {torque_limit_nm = 1.5, encoder_counts_per_turn = 400000}
joint2 = {torque_limit_nm = 0.6, encoder_counts_per_turn = 400000}
elbow_mass_kg = 0.25
tip_mass_kg = 0.05
gauges_per_link = 2
rate_hz = 500
)"},
    // Of 48 runs one trips, by the rate of the elbow; it is among the eight.
    {"LongAndHeavy", 2.4, 1, R"(material = "aluminium"
link1 = {length_m = 1.5, width_mm = 80, thickness_mm = 10}
link2 = {length_m = 1.3, width_mm = 60, thickness_mm = 8}
joint1 = {torque_limit_nm = 180, encoder_counts_per_turn = 40000, gear = 100, rotor_encoder_counts_per_turn = 2000}
joint2 = {torque_limit_nm = 60, encoder_counts_per_turn = 40000, gear = 80, rotor_encoder_counts_per_turn = 2000}
elbow_mass_kg = 6
tip_mass_kg = 2
gauges_per_link = 5
rate_hz = 100
)"},
    {"SteelWithCoarseEncoders", 1.6, 0, R"(material = "steel"
link1 = {length_m = 0.8, width_mm = 40, thickness_mm = 4}
link2 = {length_m = 0.5, width_mm = 30, thickness_mm = 2.5}
joint1 = {torque_limit_nm = 20, encoder_counts_per_turn = 2000}
joint2 = {torque_limit_nm = 5, encoder_counts_per_turn = 2000}
elbow_mass_kg = 2.5
tip_mass_kg = 0.4
gauges_per_link = 3
rate_hz = 125
)"},
    {"TenGauges", 1.6, 0, R"(material = "aluminium"
link1 = {length_m = 0.6, width_mm = 40, thickness_mm = 4}
link2 = {length_m = 0.7, width_mm = 30, thickness_mm = 3}
joint1 = {torque_limit_nm = 15, encoder_counts_per_turn = 10000, gear = 50, rotor_encoder_counts_per_turn = 4000}
joint2 = {torque_limit_nm = 6, encoder_counts_per_turn = 10000, gear = 50, rotor_encoder_counts_per_turn = 4000}
elbow_mass_kg = 1.8
tip_mass_kg = 0.2
gauges_per_link = 10
rate_hz = 200
)"},
}};

// Moves as short as the payload allows, with payloads of the rig's range: every run but
// `most_trips` completes, every move comes to rest, and later moves take at most `most` times the
// bound of a rigid arm, on average.
void ExpectFastMoves(const RigConfig& rig, double most, int most_trips) {
  constexpr std::uint64_t kFirst = 301, kRuns = 8;
  double sum = 0.0;
  int trips = 0;
  for (std::uint64_t seed = kFirst; seed < kFirst + kRuns; ++seed) {
    const RandomMoves drawn = MakeFastMoves(rig, seed, RecipeFor(rig));
    SimulationRequest request;
    request.config = rig;
    request.config.sim.seed = seed;
    request.experiment = drawn.experiment;
    request.payload_kg = drawn.payload_kg;
    const SimulationResult result = Simulate(request);
    if (!result.completed) {
      ++trips;
      std::printf("  %d: %s\n", static_cast<int>(seed), ToString(result.trip));
      continue;
    }
    const BoundRatios ratios = RatiosOf(request, result.metrics);
    EXPECT_FALSE(std::isnan(ratios.first_at_rest)) << seed;
    sum += ratios.later_at_rest;
  }
  EXPECT_LE(trips, most_trips);
  const double mean = sum / (static_cast<int>(kRuns) - trips);
  EXPECT_LE(mean, most);
  std::printf("  %.2f times the bound\n", mean);
}

class NewArm : public testing::TestWithParam<Arm> {};

// The places of these moves are not those by which the config was found.
TEST_P(NewArm, IsControlledWithoutAValueEditedByHand) {
  const TempFolder folder;
  const ArmDescription arm = ArmDescriptionReader(folder.Write("arm.toml", GetParam().text)).Read();
  const NewRigResult found = FindRig(arm, [](const std::string&) {});
  ASSERT_TRUE(found.passed) << testing::PrintToString(found.notes);
  const RigConfig rig = ParseConfig(found.text, "rig.toml");
  EXPECT_EQ(ScoreOf(rig).result, DesignVerdict::Result::kSound);
  constexpr std::array<std::uint64_t, 2> kSeeds = {101, 102};
  const MoveCheck check = CheckMoves(rig, {rig.arm.payload_mass_kg}, kSeeds, 1.0);
  EXPECT_TRUE(check.passed) << check.problem << " of " << check.permitted_mm << " mm permitted";
  RecordProperty("largest_error_mm", std::to_string(check.largest_error_mm));
  ExpectFastMoves(rig, GetParam().most_over_bound, GetParam().most_trips);
}

INSTANTIATE_TEST_SUITE_P(Described, NewArm, testing::ValuesIn(kArms),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace flexarm
