// The shortest durations by payload (docs/theory/fast-moves.md 1), against the prototype of the
// study that found the rule: another program with its own quasi-static map. Its values and the
// tolerances of the comparison are in tests/golden/fast-moves.json.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "controller/reference/path_check.h"
#include "controller/reference/path_reference.h"
#include "controller/reference/shortest_move.h"
#include "model/units.h"
#include "tests/controller/law/shipped_rig.h"
#include "tests/support/golden_data.h"
#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

PlannedMove MoveOf(const nlohmann::json& golden) {
  const auto from_deg = golden["from_deg"].get<std::array<double, 2>>();
  const auto to_deg = golden["to_deg"].get<std::array<double, 2>>();
  PlannedMove move{.row = 0,
                   .first = 0,
                   .periods = 0,
                   .retargets = false,
                   .from = {},
                   .to_rad = {RadFromDeg(to_deg[0]), RadFromDeg(to_deg[1])},
                   .profile = MoveProfile::kQuintic};
  move.from.angle_rad = {RadFromDeg(from_deg[0]), RadFromDeg(from_deg[1])};
  return move;
}

// The study's shares of the limits; the shipped ones are larger (docs/theory/fast-moves.md 1).
MotionLimits StudyLimits() {
  MotionLimits limits = ShippedLimits();
  limits.fast_fraction = {0.68, 0.58};
  return limits;
}

// Largest strain and torque of the arm bent along the move.
struct Peaks {
  std::array<double, 2> strain{}, torque_nm{};
};

Peaks PeaksOf(PlannedMove move, double payload_kg) {
  const MotionLimits limits = ShippedLimits();
  const RigidPath path({&move, 1}, move.from.angle_rad, move.periods + 1, kPeriod_s);
  Peaks peaks;
  for (const ReferenceSample& sample :
       QuasiStaticReference(path, MakeRigidJointArm(ShippedPathDesign()), payload_kg, kPeriod_s, 0,
                            move.periods + 1)) {
    for (std::size_t i = 0; i < 2; ++i) {
      const double strain = limits.root_strain_per_m[i][0] * sample.x_m[2 + 2 * i] +
                            limits.root_strain_per_m[i][1] * sample.x_m[3 + 2 * i];
      peaks.strain[i] = std::max(peaks.strain[i], std::fabs(strain));
      peaks.torque_nm[i] = std::max(peaks.torque_nm[i], std::fabs(sample.u_m_nm[i]));
    }
  }
  return peaks;
}

TEST(FastMoves, HaveTheDurationsStrainAndTorqueOfTheStudy) {
  const nlohmann::json golden = GoldenFile("fast-moves.json");
  const nlohmann::json& tolerance = golden["tolerances"];
  for (const nlohmann::json& row : golden["moves"]) {
    SCOPED_TRACE(row.dump());
    const double payload_kg = row["payload_kg"];
    PlannedMove move = MoveOf(row);
    const auto table = ShortestByPayload(move, ShippedPathDesign(), kPeriod_s, StudyLimits());
    ASSERT_TRUE(table);
    const int periods = table->Between(payload_kg, payload_kg);
    EXPECT_NEAR(periods * kPeriod_s, row["fast_T_known_s"].get<double>(),
                tolerance["fast_T_known_s"].get<double>() + 1e-9);
    move.periods = static_cast<int>(std::lround(row["fast_T_known_s"].get<double>() / kPeriod_s));
    move.is_shortest = true;
    const Peaks peaks = PeaksOf(move, payload_kg);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_NEAR(1e3 * peaks.strain[i], row["fast_pred_peak_strain_1e3"][i].get<double>(),
                  tolerance["strain"].get<double>());
      EXPECT_NEAR(peaks.torque_nm[i], row["fast_pred_peak_torque_nm"][i].get<double>(),
                  tolerance["torque"].get<double>());
    }
  }
}

TEST(FastMoves, TakeTheLongestOfThePayloadsThatArePossible) {
  DurationTable::Periods periods{};
  for (std::size_t i = 0; i < periods.size(); ++i) {
    periods[i] = static_cast<std::int16_t>(30 + (i < 10 ? 10 - i : i - 10));  // least at 0.5 kg
  }
  const DurationTable table(periods, 1.0);
  EXPECT_EQ(table.Between(0.5, 0.5), 30);
  EXPECT_EQ(table.Between(0.51, 0.52), 31) << "the next payload of the grid outside";
  EXPECT_EQ(table.Between(0.3, 0.6), 34);
  EXPECT_EQ(table.Between(-1.0, 2.0), 40);
  EXPECT_EQ(table.Longest(), 40);
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(table.Between(unknown, 0.5), 40);
  EXPECT_EQ(table.Between(0.5, std::numeric_limits<double>::infinity()), 40);
}

}  // namespace
}  // namespace flexarm
