#include "controller/operator/experiment_loader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "controller/types/rejected_error.h"
#include "tests/controller/operator/operator_records.h"
#include "tests/controller/operator/still_stack.h"
#include "tests/support/loop_time.h"
#include "tests/support/message_of.h"

namespace flexarm {
namespace {

using testing::HasSubstr;

Experiment OneMove(const std::string& name, double to_deg, const std::string& more = "") {
  return ParseExperiment("name = \"" + name +
                             "\"\nduration_s = 4.0\n[[move]]\nstart_s = 0.0\nduration_s = 3.0\n"
                             "to_deg = [" +
                             std::to_string(to_deg) + ", 0.0]\n" + more,
                         name);
}

struct ExperimentLoaderTest : testing::Test {
  void Plan(const Experiment& experiment) { loader.Plan(40 * kMs, experiment, {0.0, 0.0}); }

  StillStack stack;
  EventQueue events{64};
  ExperimentLoader loader{&stack, &events, &ShippedDesign(), LoopGrid(ShippedRig().loop),
                          ShippedLimits()};
};

TEST_F(ExperimentLoaderTest, TheNextRunFollowsTheNewestExperiment) {
  EXPECT_EQ(loader.name(), "");
  Plan(OneMove("there", 20.0));
  Plan(OneMove("back", 0.0));
  EXPECT_EQ(loader.name(), "back");
  EXPECT_EQ(stack.planned.number, 2u);
  EXPECT_EQ(stack.planned.experiment->accepted.name, "back");
}

TEST_F(ExperimentLoaderTest, EachIsAnEventWithItsWholeFile) {
  Plan(OneMove("there", 20.0));
  loader.Load(60 * kMs, std::make_unique<PlannedExperiment>(HomingPlan{}), "home", "{\"joint\":1}");
  const std::vector<RunEvent> logged = TakeEvents(&events);
  ASSERT_EQ(logged.size(), 2u);
  EXPECT_EQ(logged[0].kind, "experiment");
  EXPECT_EQ(logged[0].name, "there");
  EXPECT_EQ(logged[0].time_ns, 40 * kMs);
  EXPECT_EQ(logged[0].text, OneMove("there", 20.0).text);
  EXPECT_EQ(logged[1].kind, "experiment");
  EXPECT_EQ(logged[1].name, "home");
  EXPECT_EQ(logged[1].time_ns, 60 * kMs);
  EXPECT_EQ(logged[1].text, "{\"joint\":1}");
}

TEST_F(ExperimentLoaderTest, OneIsKeptUntilTheLoopHasReleasedIt) {
  for (const char* name : {"first", "second", "third"}) Plan(OneMove(name, 10.0));
  loader.FreeReleased();
  EXPECT_EQ(loader.size(), 3u);
  stack.released = 1;
  loader.FreeReleased();
  EXPECT_EQ(loader.size(), 3u) << "number 1 is still followed";
  stack.released = 3;
  loader.FreeReleased();
  EXPECT_EQ(loader.size(), 1u);
  EXPECT_EQ(stack.planned.experiment->accepted.name, "third");
}

TEST_F(ExperimentLoaderTest, ARealRigRefusesEventsThatAreSimulated) {
  const Experiment dropped =
      OneMove("dropped", 20.0, "[[sim_event]]\nat_s = 1.0\npayload_kg = 0.0\n");
  Plan(dropped);
  EXPECT_EQ(loader.size(), 1u) << "a simulated one takes them";
  stack.is_simulated = false;
  EXPECT_THAT(MessageOf<RejectedError>([&] { Plan(dropped); }), HasSubstr("sim_event"));
  Plan(OneMove("without", 20.0));
  EXPECT_EQ(loader.name(), "without");
}

TEST_F(ExperimentLoaderTest, ARefusedExperimentLeavesTheLoadedOne) {
  Plan(OneMove("there", 20.0));
  TakeEvents(&events);
  EXPECT_THROW(Plan(OneMove("too-far", 170.0)), RejectedError);
  EXPECT_EQ(loader.name(), "there");
  EXPECT_EQ(loader.size(), 1u);
  EXPECT_EQ(stack.planned.number, 1u);
  EXPECT_TRUE(TakeEvents(&events).empty());
}

TEST_F(ExperimentLoaderTest, AMoveBeginsWhereTheHubsAre) {
  loader.Plan(0, OneMove("there", 20.0), {0.1, 0.0});
  EXPECT_NEAR(stack.planned.experiment->reference.At(0).x_m[0], 0.1, 1e-12);
}

}  // namespace
}  // namespace flexarm
