// The reference of a run whose durations are chosen while it runs: against the table of the
// accepted experiment, and against the table of an experiment with the chosen durations.

#include "controller/reference/timed_reference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/controller/law/shipped_rig.h"
#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

constexpr PayloadKnowledge kKnown = {.payload_kg = 0.1,
                                     .payload_sigma_kg = 0.01,
                                     .friction_nm = {0.1, 0.01},
                                     .mean_nis = 8.0,
                                     .warnings = 0};

Move ShortestTo(double start_s, std::array<double, 2> to_deg, bool same_load) {
  Move move{.start_s = start_s, .to_deg = to_deg};
  move.shortest = true;
  move.same_load = same_load;
  return move;
}

Experiment ThreeMoves() {
  return {.name = "fast",
          .text = "",
          .duration_s = 12.0,
          .doublet = {},
          .sim_event = {},
          .move = {ShortestTo(0.0, {30, 30}, false), ShortestTo(4.0, {0, 0}, true),
                   ShortestTo(8.0, {-20, 40}, true)}};
}

ReferenceTable TableOf(const Experiment& experiment) {
  return {experiment, ShippedPathDesign(), kPeriod_s, {0.0, 0.0}, ShippedLimits()};
}

// The last sample at which the path moves, from `first` on.
int LastMoving(const TimedReference& reference, int first, int until) {
  int last = first;
  for (int k = first; k < until; ++k) {
    const RigidPoint point = reference.PathAround(k)[1];
    if (point.rate_rad_s[0] != 0.0) last = k;
  }
  return last;
}

TEST(TimedReference, IsTheTableBeforeAndWithoutAChoice) {
  const ReferenceTable table = TableOf(ThreeMoves());
  TimedReference reference;
  reference.Start(&table, nullptr);
  for (int k = -1; k < 200; ++k) {
    reference.Choose(k, kKnown);
    EXPECT_EQ(reference.At(k).x_m, table.At(k).x_m) << k;
    EXPECT_EQ(reference.At(k).u_m_nm, table.At(k).u_m_nm) << k;
  }
  EXPECT_FALSE(table.moves()[0].choice) << "any payload is possible";
}

TEST(TimedReference, FollowsAMoveOfTheChosenDuration) {
  const ReferenceTable table = TableOf(ThreeMoves());
  PlannedMove shorter = table.moves()[1];
  shorter.periods = shorter.choice.value().Between(0.08, 0.12);
  ASSERT_LT(shorter.periods, table.moves()[1].periods);
  const RigidJointArm arm = MakeRigidJointArm(ShippedPathDesign());
  TimedReference reference;
  reference.Start(&table, nullptr);
  for (int k = 0; k < 395; ++k) {
    reference.Choose(k, kKnown);
    if (k < 202) continue;
    const std::array<RigidPoint, 3> path = {shorter.At(k - 1, kPeriod_s), shorter.At(k, kPeriod_s),
                                            shorter.At(k + 1, kPeriod_s)};
    const ReferenceSample bent =
        QuasiStaticSample(arm, ShippedPathDesign().scheduled->reference_kg, path, kPeriod_s);
    EXPECT_EQ(reference.At(k).x_m, bent.x_m) << k;
    EXPECT_EQ(reference.At(k).u_m_nm, bent.u_m_nm) << k;
    EXPECT_EQ(reference.PathAround(k)[1].angle_rad, path[1].angle_rad) << k;
    EXPECT_TRUE(reference.KeepsLoad(k));
  }
  EXPECT_EQ(LastMoving(reference, 200, 395), 200 + shorter.periods - 1);
}

TEST(TimedReference, KeepsAChoiceAndEndsAtTheNextMove) {
  const ReferenceTable table = TableOf(ThreeMoves());
  TimedReference reference;
  reference.Start(&table, nullptr);
  reference.Choose(199, kKnown);
  const int last = LastMoving(reference, 200, 400);
  PayloadKnowledge heavier = kKnown;
  heavier.payload_kg = 0.9;
  reference.Choose(250, heavier);
  EXPECT_EQ(LastMoving(reference, 200, 400), last) << "a move in flight is not changed";
  reference.Choose(399, heavier);
  EXPECT_EQ(LastMoving(reference, 400, 600),
            400 + table.moves()[2].choice.value().Between(0.88, 0.92) - 1);
}

// 4 s and 8 s are samples 200 and 400.
TEST(TimedReference, TakesTheLongestWhenThePayloadIsNotKnown) {
  const ReferenceTable table = TableOf(ThreeMoves());
  const int longest = table.moves()[1].periods;
  for (const auto& change : std::vector<void (*)(PayloadKnowledge*)>{
           [](PayloadKnowledge* known) { *known = kNoPayloadEstimate; },
           [](PayloadKnowledge* known) { known->warnings = kPayloadAtBound; },
           [](PayloadKnowledge* known) { known->warnings = kPayloadModelMismatch; },
           [](PayloadKnowledge* known) { known->payload_sigma_kg = 0.5; }}) {
    PayloadKnowledge known = kKnown;
    change(&known);
    TimedReference reference;
    reference.Start(&table, nullptr);
    reference.Choose(199, known);
    EXPECT_EQ(LastMoving(reference, 200, 400), 200 + longest - 1);
  }
}

TEST(TimedReference, AnAnnouncedChangeOfTheLoadEndsTheSameLoad) {
  Experiment experiment = ThreeMoves();
  experiment.load_change = {{.at_s = 6.0}};
  const ReferenceTable table = TableOf(experiment);
  EXPECT_TRUE(table.moves()[1].choice);
  EXPECT_FALSE(table.moves()[2].choice) << "planned for any payload";
  const std::vector<int> load_change = {300};
  TimedReference reference;
  reference.Start(&table, &load_change);
  reference.Choose(450, kKnown);
  EXPECT_TRUE(reference.KeepsLoad(250));
  EXPECT_FALSE(reference.KeepsLoad(450));
  EXPECT_TRUE(reference.LoadChanges(300));
  EXPECT_FALSE(reference.LoadChanges(299));
}

TEST(TimedReference, AMoveBelowMayNotBeginBeforeTheLongestDurationEnds) {
  Experiment experiment = ThreeMoves();
  experiment.move[1].start_s = 0.5;
  const ReferenceTable table = TableOf(experiment);
  EXPECT_TRUE(table.moves()[1].retargets) << "it retargets a move whose end is not known";
  EXPECT_FALSE(table.moves()[1].choice);
}

}  // namespace
}  // namespace flexarm
