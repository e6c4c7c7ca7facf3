#include "controller/tasks/planned_experiment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "controller/reference/motion_change.h"
#include "controller/types/rejected_error.h"
#include "tests/controller/tasks/control_task_bench.h"
#include "tests/support/message_of.h"

namespace flexarm {
namespace {

using testing::ElementsAre;

Experiment AMoveAtSpeed(double speed) {
  Experiment experiment = AMove(0.2, 10.0);
  experiment.speed = speed;
  return experiment;
}

TEST(PlannedExperiment, IsFollowedAsPlannedAtFullSpeed) {
  for (const Design* design : {&ShippedDesign(), &ShippedPathDesign()}) {
    const PlannedExperiment planned = Planned(AMoveAtSpeed(1.0), *design);
    EXPECT_EQ(planned.mode, LoopMode::kFollow);
    EXPECT_EQ(planned.reference.periods(), 200);
    EXPECT_EQ(planned.accepted.name, "a-move");
    EXPECT_EQ(planned.changes_at, 0);
    EXPECT_FALSE(planned.keeps_own_time) << "plans ahead apply";
  }
}

TEST(PlannedExperiment, ALawThatFollowsAPathKeepsItsPlanAtHalfSpeed) {
  const PlannedExperiment planned = Planned(AMoveAtSpeed(0.5), ShippedPathDesign());
  EXPECT_TRUE(planned.keeps_own_time);
  EXPECT_TRUE(planned.reference.path_plan().has_value());
  EXPECT_EQ(WhyNoChange(planned.reference), "") << "it can be made faster again";
  EXPECT_GT(planned.reference.periods(), 350);
  EXPECT_DOUBLE_EQ(planned.accepted.duration_s, planned.reference.periods() * kPeriod_s);
  EXPECT_DOUBLE_EQ(planned.accepted.move.at(0).duration_s.value(), 4.0);
}

TEST(PlannedExperiment, AtAnySpeedLastsAsLongAsItsReference) {
  for (const Design* design : {&ShippedDesign(), &ShippedPathDesign()}) {
    for (const double speed : {0.9, 0.7, 0.3, 0.13}) {
      const PlannedExperiment planned = Planned(AMoveAtSpeed(speed), *design);
      EXPECT_DOUBLE_EQ(planned.accepted.duration_s, planned.reference.periods() * kPeriod_s)
          << speed;
    }
  }
}

TEST(PlannedExperiment, AnotherLawGetsSlowerRows) {
  const PlannedExperiment planned = Planned(AMoveAtSpeed(0.5), ShippedDesign());
  EXPECT_FALSE(planned.keeps_own_time);
  EXPECT_EQ(planned.reference.periods(), 400);
  EXPECT_DOUBLE_EQ(planned.accepted.move.at(0).start_s, 0.4);
  EXPECT_DOUBLE_EQ(planned.accepted.move.at(0).duration_s.value(), 4.0);
}

TEST(PlannedExperiment, AnnouncesEachChangeOfThePayloadAtItsSample) {
  Experiment experiment = AMove(0.0, 10.0);
  experiment.load_change = {{.at_s = 0.3}, {.at_s = 2.5}};
  EXPECT_THAT(Planned(experiment, ShippedDesign()).load_change, ElementsAre(15, 125));
}

SimEvent EventAt(double at_s, int level, Line line = Line::kLimit1Low) {
  SimEvent event{};
  event.at_s = at_s;
  event.line = line;
  event.level = level;
  return event;
}

// Of two at one instant the second row holds.
TEST(PlannedExperiment, HasItsSimulatedEventsInOrderOfTimeAndThenOfTheRows) {
  Experiment experiment = AMove(0.0, 10.0);
  experiment.sim_event = {EventAt(2.0, 0, Line::kLimit2Low), EventAt(1.0, 0), EventAt(1.0, 1),
                          EventAt(0.5, 0, Line::kLimit2High)};
  const PlannedExperiment planned = Planned(experiment, ShippedDesign());
  ASSERT_EQ(planned.sim_events.size(), 4u);
  EXPECT_EQ(planned.sim_events[0].line, Line::kLimit2High);
  EXPECT_EQ(planned.sim_events[1].level, 0);
  EXPECT_EQ(planned.sim_events[2].level, 1);
  EXPECT_EQ(planned.sim_events[3].line, Line::kLimit2Low);
}

TEST(PlannedExperiment, WithAnotherPathIsTheSameRun) {
  Experiment experiment = AMove(0.2, 10.0);
  experiment.sim_event = {EventAt(1.0, 1)};
  const PlannedExperiment before = Planned(experiment, ShippedPathDesign());
  const PlannedExperiment changed(
      before, WithSpeed(before.reference, 60, 0.5, ShippedPathDesign(), ShippedLimits()), 60);
  EXPECT_EQ(changed.changes_at, 60);
  EXPECT_TRUE(changed.keeps_own_time);
  EXPECT_EQ(changed.mode, LoopMode::kFollow);
  EXPECT_EQ(changed.accepted.name, "a-move");
  EXPECT_EQ(changed.sim_events.size(), 1u);
  EXPECT_GT(changed.reference.periods(), before.reference.periods());
}

TEST(PlannedExperiment, OfTorquesIsAnOpenLoop) {
  const PlannedExperiment pluck({{0.5, 0.0}, {-0.5, 0.1}, {0.25, 0.0}});
  EXPECT_EQ(pluck.mode, LoopMode::kOpenLoop);
  EXPECT_EQ(pluck.reference.periods(), 3);
}

TEST(PlannedExperiment, OfASearchForASwitchRegulates) {
  HomingPlan plan{};
  plan.line = Line::kLimit2High;
  const PlannedExperiment homing(plan);
  EXPECT_EQ(homing.mode, LoopMode::kRegulate);
  EXPECT_EQ(homing.homing.line, Line::kLimit2High);
  EXPECT_EQ(homing.reference.periods(), 1);
}

TEST(PlannedExperiment, AHardwareRigRefusesSimulatedEvents) {
  Experiment experiment = AMove(0.0, 10.0);
  EXPECT_NO_THROW(RefuseSimEvents(experiment));
  experiment.sim_event = {EventAt(1.0, 1)};
  EXPECT_THAT(MessageOf<RejectedError>([&] { RefuseSimEvents(experiment); }),
              testing::HasSubstr("sim_event[0]"));
}

}  // namespace
}  // namespace flexarm
