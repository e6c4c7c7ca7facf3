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

// A change of a run, planned as another table: what is tested is who keeps it, and until when.
struct ExperimentChangeTest : ExperimentLoaderTest {
  ExperimentLoader::Order ChangeOf(std::uint32_t run) {
    return experiments_.PlanChange(*experiments_.Find(run), 33,
                                   [this](const ReferenceTable& table, int from,
                                          const Design& design, const MotionLimits& limits) {
                                     EXPECT_EQ(table.periods(), 200);
                                     EXPECT_EQ(from, 33);
                                     EXPECT_EQ(&design, &ShippedDesign());
                                     hub_rate_rad_s_ = limits.hub_rate_rad_s;
                                     return ReferenceTable(OneMove("other", 2.0), design, kPeriod_s,
                                                           {0.0, 0.0}, limits);
                                   });
  }
  std::uint32_t AskForChange(std::uint32_t run) {
    return experiments_.AskForChange(now_.now_ns, 7, ChangeOf(run),
                                     {.run = run, .not_after_ns = 500 * kMs});
  }

  std::array<double, 2> hub_rate_rad_s_{};  // of the limits with which a path was planned
};

TEST_F(ExperimentChangeTest, TheRequestCarriesTheRunAndItsChange) {
  const std::uint32_t run = AskAndGrant(OneMove("there", 20.0));
  stack_.TakeRequests();
  TakeEvents(&events_);
  EXPECT_FALSE(experiments_.busy());
  const std::uint32_t number = AskForChange(run);
  const std::vector<OperatorRequest> made = stack_.TakeRequests();
  ASSERT_EQ(made.size(), 1U);
  EXPECT_EQ(made[0].kind, RequestKind::kChange);
  EXPECT_EQ(made[0].number, number);
  EXPECT_EQ(made[0].not_before_ns, now_.now_ns);
  EXPECT_EQ(made[0].changes, run);
  EXPECT_EQ(made[0].not_after_ns, 500 * kMs);
  EXPECT_EQ(made[0].run.experiment, experiments_.Find(number).get());
  EXPECT_EQ(made[0].run.experiment->changes_at, 33);
  EXPECT_EQ(made[0].run.experiment->accepted.name, "there") << "the run stays the same";
  EXPECT_TRUE(experiments_.busy());
  EXPECT_THAT(TakeEvents(&events_), IsEmpty()) << "a change is no experiment";
  EXPECT_EQ(AskForChange(run), 0U) << "one at a time";
  EXPECT_EQ(experiments_.size(), 2U);
  Answered(RequestKind::kChange, number, Refusal::kNone);
  EXPECT_EQ(clients_, std::vector<int>{7});
  EXPECT_EQ(experiments_.name(), "there");
  EXPECT_NE(experiments_.Find(number), experiments_.Find(run));
  EXPECT_EQ(experiments_.Find(number + 1), nullptr);
}

TEST_F(ExperimentChangeTest, APathIsPlannedWithTheLimitsThatHold) {
  const std::uint32_t run = AskAndGrant(OneMove("there", 5.0));
  ChangeOf(run);
  EXPECT_EQ(hub_rate_rad_s_, ShippedLimits().hub_rate_rad_s);
  stack_.SetReduced(true);
  ChangeOf(run);
  EXPECT_EQ(hub_rate_rad_s_, MotionLimitsOf(config_, true).hub_rate_rad_s);
  EXPECT_NE(hub_rate_rad_s_, ShippedLimits().hub_rate_rad_s);
}

TEST_F(ExperimentChangeTest, ARefusedOneIsForgottenAndTheRunGoesOn) {
  const std::uint32_t run = AskAndGrant(OneMove("there", 20.0));
  const std::uint32_t number = AskForChange(run);
  Answered(RequestKind::kStop, number + 1, Refusal::kWrongState);
  EXPECT_EQ(experiments_.size(), 2U) << "the answer to another request";
  Answered(RequestKind::kChange, number, Refusal::kTooLate);
  EXPECT_EQ(experiments_.Find(number), nullptr);
  EXPECT_NE(experiments_.Find(run), nullptr);
  EXPECT_EQ(experiments_.name(), "there");
}

TEST_F(ExperimentChangeTest, AnnouncedChangesOfThePayloadKeepThePath) {
  const std::uint32_t run = AskAndGrant(OneMove("loads", 20.0, "[[load_change]]\nat_s = 3.5\n"));
  EXPECT_THAT(MessageOf<RejectedError>([&] { ChangeOf(run); }), HasSubstr("[[load_change]]"));
}

TEST_F(ExperimentLoaderTest, ReducedLimitsAreAnEventBeforeTheRun) {
  AskAndGrant(OneMove("full", 10.0));
  EXPECT_EQ(TakeEvents(&events_).size(), 1U);
  stack_.SetReduced(true);
  AskAndGrant(OneMove("slow", 10.0));
  const std::vector<RunEvent> logged = TakeEvents(&events_);
  ASSERT_EQ(logged.size(), 2U);
  EXPECT_EQ(logged[0].kind, "limits");
  EXPECT_EQ(logged[0].name, "reduced");
  EXPECT_EQ(logged[0].time_ns, now_.now_ns);
  EXPECT_THAT(logged[0].text, HasSubstr("safety.reduced"));
  EXPECT_EQ(logged[1].name, "slow");
}

// Announced for a run that others ask for: its name is known before it is granted.
TEST_F(ExperimentLoaderTest, ARunOfOthersIsNamedWhenItIsAnnounced) {
  experiments_.Announce(now_.now_ns, experiments_.Plan(OneMove("unattended", 10.0), {0.0, 0.0}));
  EXPECT_EQ(experiments_.name(), "unattended");
  EXPECT_EQ(experiments_.size(), 0U);
}

}  // namespace
}  // namespace flexarm
