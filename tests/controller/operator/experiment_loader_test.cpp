#include "controller/operator/experiment_loader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "controller/types/rejected_error.h"
#include "tests/controller/operator/operator_parts.h"
#include "tests/support/message_of.h"

namespace flexarm {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

Experiment OneMove(const std::string& name, double to_deg, const std::string& more = "") {
  return ParseExperiment("name = \"" + name +
                             "\"\nduration_s = 4.0\n[[move]]\nstart_s = 0.0\nduration_s = 3.0\n"
                             "to_deg = [" +
                             std::to_string(to_deg) + ", 0.0]\n" + more,
                         name);
}

struct ExperimentLoaderTest : OperatorParts {
  ExperimentLoaderTest() : OperatorParts(ShippedRig()) {}

  // @returns the number of the run that is asked for; 0: it is not
  std::uint32_t Ask(const Experiment& experiment) {
    return experiments_.AskForRun(now_.now_ns, 7, experiments_.Plan(experiment, {0.0, 0.0}));
  }
  std::uint32_t AskAndGrant(const Experiment& experiment) {
    const std::uint32_t number = Ask(experiment);
    Answered(RequestKind::kRun, number, Refusal::kNone);
    return number;
  }
};

TEST_F(ExperimentLoaderTest, TheRequestCarriesItsExperiment) {
  const std::uint32_t number = Ask(OneMove("there", 20.0));
  const std::vector<OperatorRequest> made = stack_.TakeRequests();
  ASSERT_EQ(made.size(), 1u);
  EXPECT_EQ(made[0].number, number);
  EXPECT_EQ(made[0].run.experiment->accepted.name, "there");
  EXPECT_EQ(made[0].run.may_open, 0);
  EXPECT_EQ(experiments_.name(), "") << "not granted yet";
}

// Two commands in one poll: the second is refused and leaves no trace.
TEST_F(ExperimentLoaderTest, OneRunIsAskedForAtATime) {
  const std::uint32_t first = Ask(OneMove("first", 20.0));
  EXPECT_EQ(Ask(OneMove("second", 10.0)), 0u);
  EXPECT_EQ(stack_.TakeRequests().size(), 1u);
  EXPECT_EQ(experiments_.size(), 1u);
  Answered(RequestKind::kRun, first, Refusal::kNone);
  EXPECT_EQ(experiments_.name(), "first");
  EXPECT_EQ(TakeEvents(&events_).size(), 1u);
}

TEST_F(ExperimentLoaderTest, AGrantedOneIsAnEventWithItsWholeFile) {
  AskAndGrant(OneMove("there", 20.0));
  const std::uint32_t home =
      experiments_.AskForRun(now_.now_ns, RequestTracker::kNoClient,
                             {.planned = std::make_unique<PlannedExperiment>(HomingPlan{}),
                              .name = "home",
                              .text = "{\"joint\":1}",
                              .may_open = 0b100});
  Answered(RequestKind::kRun, home, Refusal::kNone);
  EXPECT_EQ(stack_.TakeRequests().back().run.may_open, 0b100);
  const std::vector<RunEvent> logged = TakeEvents(&events_);
  ASSERT_EQ(logged.size(), 2u);
  EXPECT_EQ(logged[0].kind, "experiment");
  EXPECT_EQ(logged[0].name, "there");
  EXPECT_EQ(logged[0].time_ns, now_.now_ns);
  EXPECT_EQ(logged[0].text, OneMove("there", 20.0).text);
  EXPECT_EQ(logged[1].name, "home");
  EXPECT_EQ(logged[1].text, "{\"joint\":1}");
}

TEST_F(ExperimentLoaderTest, ARefusedOneIsForgotten) {
  AskAndGrant(OneMove("there", 20.0));
  TakeEvents(&events_);
  const std::uint32_t refused = Ask(OneMove("back", 0.0));
  Answered(RequestKind::kRun, refused, Refusal::kWrongState);
  EXPECT_EQ(experiments_.name(), "there");
  EXPECT_EQ(experiments_.size(), 1u);
  // Announced, with its number: it names no run, for none was granted with that (RunContext).
  const std::vector<RunEvent> logged = TakeEvents(&events_);
  ASSERT_EQ(logged.size(), 1u);
  EXPECT_EQ(nlohmann::json::parse(logged[0].value_json)["number"], refused);
}

TEST_F(ExperimentLoaderTest, OneIsKeptUntilTheLoopHasReleasedIt) {
  const std::uint32_t first = AskAndGrant(OneMove("first", 10.0));
  AskAndGrant(OneMove("second", 10.0));
  const std::uint32_t third = AskAndGrant(OneMove("third", 10.0));
  experiments_.FreeReleased();
  EXPECT_EQ(experiments_.size(), 3u);
  stack_.released = first;
  experiments_.FreeReleased();
  EXPECT_EQ(experiments_.size(), 3u) << "the first is still followed";
  stack_.released = third;
  experiments_.FreeReleased();
  EXPECT_EQ(experiments_.size(), 1u);
  EXPECT_EQ(stack_.TakeRequests().back().run.experiment->accepted.name, "third");
}

TEST_F(ExperimentLoaderTest, ARealRigRefusesEventsThatAreSimulated) {
  const Experiment dropped =
      OneMove("dropped", 20.0, "[[sim_event]]\nat_s = 1.0\npayload_kg = 0.0\n");
  AskAndGrant(dropped);
  EXPECT_EQ(experiments_.size(), 1u) << "a simulated one takes them";
  stack_.is_simulated = false;
  EXPECT_THAT(MessageOf<RejectedError>([&] { Ask(dropped); }), HasSubstr("sim_event"));
  EXPECT_NE(Ask(OneMove("without", 20.0)), 0u);
}

TEST_F(ExperimentLoaderTest, AnImpossibleOneChangesNothing) {
  AskAndGrant(OneMove("there", 20.0));
  TakeEvents(&events_);
  stack_.TakeRequests();
  EXPECT_THROW(Ask(OneMove("too-far", 170.0)), RejectedError);
  EXPECT_EQ(experiments_.name(), "there");
  EXPECT_EQ(experiments_.size(), 1u);
  EXPECT_THAT(stack_.TakeRequests(), IsEmpty());
  EXPECT_THAT(TakeEvents(&events_), IsEmpty());
}

TEST_F(ExperimentLoaderTest, AMoveBeginsWhereTheHubsAre) {
  const ExperimentLoader::Order order = experiments_.Plan(OneMove("there", 20.0), {0.1, 0.0});
  EXPECT_NEAR(order.planned->reference.At(0).x_m[0], 0.1, 1e-12);
}

}  // namespace
}  // namespace flexarm
