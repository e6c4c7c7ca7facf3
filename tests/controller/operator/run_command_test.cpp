#include "controller/operator/run_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>

#include "controller/runlog/run_label.h"
#include "controller/types/rejected_error.h"
#include "tests/controller/operator/operator_parts.h"
#include "tests/support/message_of.h"

namespace flexarm {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kRunClient = 7;
constexpr const char* kPlannedMove =
    "name = \"one-move\"\nduration_s = 2.0\n"
    "[[move]]\nstart_s = 0.0\nduration_s = 1.8\nto_deg = [10.0, 0.0]\n";

class RunCommandTest : public OperatorParts {
 protected:
  RunCommandTest() : OperatorParts(ShippedRig()) {}
  ~RunCommandTest() override { held_ = judging_held_ = false; }

  // Held: the plan is not there until the test releases it.
  RunCommand::Targets TargetsOf() {
    return {.experiments = &experiments_,
            .commissioning = &commissioning_,
            .switches = &switches_,
            .overrides = &overrides_,
            .parse_experiment =
                [this](const std::string& text, const std::string& name) {
                  while (held_) std::this_thread::yield();
                  return ParseExperiment(text, name);
                },
            .judge_experiment =
                [this](const Experiment&, const std::array<double, 2>& start_rad,
                       const std::stop_token& stop) {
                  judging_begun_ = true;
                  while (judging_held_ && !stop.stop_requested()) std::this_thread::yield();
                  given_up_ = stop.stop_requested();
                  judged_from_rad_ = start_rad;
                  return objection_;
                },
            .plan_wait = {}};
  }
  void ObjectToTheExperiment() {
    objection_ = UnmetCondition{.name = kExperimentCondition,
                                .refusal = "predicted-trip",
                                .found = "it trips by bending-strain-1",
                                .remedy = "controller.name = \"gain-scheduled\" completes it",
                                .may_override = true};
  }
  Json Start(const std::string& experiment = kPlannedMove) {
    return run_.Start({{"command", "run"}, {"experiment", experiment}}, kRunClient, now_);
  }
  std::optional<ClientAnswer> Follow() {
    return run_.Follow(now_, [this](int) { return client_is_there_; });
  }
  // The period in which the plan is there.
  std::optional<ClientAnswer> FollowToTheEnd() {
    held_ = false;
    std::optional<ClientAnswer> answer;
    while (run_.planning() && !answer) answer = Follow();
    return answer;
  }

  std::atomic<bool> held_ = true;
  std::atomic<bool> judging_held_ = false;
  std::atomic<bool> judging_begun_ = false;
  std::atomic<bool> given_up_ = false;
  std::optional<UnmetCondition> objection_;
  std::array<double, 2> judged_from_rad_{};
  bool client_is_there_ = true;
  RunCommand run_{TargetsOf()};  // in place of the one that waits
};

TEST_F(RunCommandTest, TheOperatorGoesOnWhileARunIsPlannedAndThenAsksForIt) {
  EXPECT_TRUE(Start().is_null());
  EXPECT_TRUE(run_.planning());
  for (int k = 0; k < 100; ++k) EXPECT_FALSE(Follow());
  EXPECT_THAT(stack_.TakeRequests(), IsEmpty());
  EXPECT_FALSE(FollowToTheEnd()) << "the safety task answers";
  const std::vector<OperatorRequest> made = stack_.TakeRequests();
  ASSERT_EQ(made.size(), 1u);
  EXPECT_EQ(made[0].run.experiment->accepted.name, "one-move");
  EXPECT_FALSE(run_.planning());
  EXPECT_FALSE(Follow());
}

TEST_F(RunCommandTest, AnExperimentThatIsWrongIsAnsweredWithTheReason) {
  EXPECT_TRUE(Start("name = 3\n").is_null());
  const std::optional<ClientAnswer> answer = FollowToTheEnd();
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->client, kRunClient);
  EXPECT_EQ(answer->json["ok"], false);
  EXPECT_EQ(answer->json["command"], "run");
  EXPECT_EQ(answer->json["refusal"], "experiment-refused");
  EXPECT_EQ(answer->json["state"], "Armed");
  EXPECT_THAT(answer->json.value("error", ""), HasSubstr("name"));
  EXPECT_THAT(stack_.TakeRequests(), IsEmpty());
}

TEST_F(RunCommandTest, AStopADisarmTheEndOfTheDaemonAndAClientThatHasGoneCancelAPlan) {
  for (const int reason : {0, 1, 2}) {
    held_ = true;
    client_is_there_ = true;
    now_.shutting_down = false;
    EXPECT_TRUE(Start().is_null());
    if (reason == 0) run_.Cancel();
    now_.shutting_down = reason == 1;
    client_is_there_ = reason != 2;
    const std::optional<ClientAnswer> answer = Follow();
    ASSERT_TRUE(answer) << reason;
    EXPECT_EQ(answer->json["refusal"], reason == 1 ? "shutting-down" : "cancelled") << reason;
    EXPECT_FALSE(run_.planning());
    held_ = false;
    for (int k = 0; k < 1'000; ++k) EXPECT_FALSE(Follow());
  }
  EXPECT_THAT(stack_.TakeRequests(), IsEmpty());
}

TEST_F(RunCommandTest, ACancelledRunDoesNotCancelTheNext) {
  run_.Cancel();
  EXPECT_TRUE(Start().is_null());
  run_.Cancel();
  EXPECT_EQ(Follow()->json["refusal"], "cancelled");
  EXPECT_TRUE(Start().is_null());
  EXPECT_FALSE(FollowToTheEnd());
  EXPECT_EQ(stack_.TakeRequests().size(), 1u);
}

TEST_F(RunCommandTest, IsNotPlannedWhereItWouldBeRefused) {
  now_.shutting_down = true;
  const Json ends = Start();
  EXPECT_EQ(ends["refusal"], "shutting-down");
  EXPECT_EQ(ends["command"], "run");
  EXPECT_EQ(ends["state"], "Armed");
  now_.shutting_down = false;
  now_.permit.state = SafetyState::kIdle;
  const Json idle = Start();
  EXPECT_EQ(idle["refusal"], "wrong-state");
  EXPECT_EQ(idle["ok"], false);
  EXPECT_EQ(idle["command"], "run");
  EXPECT_EQ(idle["state"], "Idle");
  EXPECT_FALSE(run_.planning());
}

// What has changed while it was planned.
TEST_F(RunCommandTest, TheConditionsAreJudgedAgainWhenThePlanIsThere) {
  EXPECT_TRUE(Start().is_null());
  now_.permit.state = SafetyState::kTripped;
  EXPECT_EQ(FollowToTheEnd()->json["refusal"], "wrong-state");
  held_ = true;
  EXPECT_EQ(Start()["refusal"], "wrong-state");
  now_.permit.state = SafetyState::kArmed;
  EXPECT_TRUE(Start().is_null());
  now_.tick.output.angle_rad[1] += 2.0 * RunCommand::kMoved_rad;
  const std::optional<ClientAnswer> moved = FollowToTheEnd();
  EXPECT_THAT(moved->json.value("error", ""), HasSubstr("was moved"));
  EXPECT_EQ(moved->json["refusal"], "arm-moved");
}

TEST_F(RunCommandTest, AnArmThatStandsWhereThePlanBeginsIsRun) {
  now_.tick.output.angle_rad[0] = 0.1;
  now_.tick.output.angle_rad[1] = -0.2;
  EXPECT_TRUE(Start().is_null());
  now_.tick.output.angle_rad[0] += 0.009;
  now_.tick.output.angle_rad[1] -= 0.009;
  EXPECT_FALSE(FollowToTheEnd());
  EXPECT_EQ(judged_from_rad_, (std::array{0.1, -0.2}));
  const std::vector<OperatorRequest> made = stack_.TakeRequests();
  ASSERT_EQ(made.size(), 1u);
  EXPECT_DOUBLE_EQ(made[0].run.experiment->reference.At(0).x_m[0], 0.1);
}

TEST_F(RunCommandTest, AnArmOfWhichEitherJointWasMovedIsNotRun) {
  for (const std::size_t joint : {0U, 1U}) {
    held_ = true;
    EXPECT_TRUE(Start().is_null());
    now_.tick.output.angle_rad[joint] -= 0.011;
    const std::optional<ClientAnswer> answer = FollowToTheEnd();
    ASSERT_TRUE(answer) << joint;
    EXPECT_EQ(answer->json["refusal"], "arm-moved");
  }
  EXPECT_THAT(stack_.TakeRequests(), IsEmpty());
}

TEST_F(RunCommandTest, TheSwitchesMayBeOverriddenToo) {
  EXPECT_TRUE(run_.Start({{"command", "run"},
                          {"experiment", kPlannedMove},
                          {"overrides", {{kSwitchesCondition, "seen to work"}}}},
                         kRunClient, now_)
                  .is_null());
  EXPECT_FALSE(FollowToTheEnd());
  EXPECT_EQ(stack_.TakeRequests().size(), 1u);
}

TEST_F(RunCommandTest, APlanWaitsForTheAnswerToAReset) {
  EXPECT_TRUE(Start().is_null());
  const std::uint32_t reset = requests_.Ask(RequestKind::kReset, now_.now_ns).number;
  held_ = false;
  for (int k = 0; k < 1'000; ++k) EXPECT_FALSE(Follow());
  EXPECT_TRUE(run_.planning());
  EXPECT_EQ(stack_.TakeRequests().size(), 1u) << "the reset";
  Answered(RequestKind::kReset, reset, Refusal::kNone);
  EXPECT_FALSE(FollowToTheEnd());
  EXPECT_EQ(stack_.TakeRequests().at(0).kind, RequestKind::kRun);
}

TEST_F(RunCommandTest, TheDaemonEndsWhileAPlanIsMade) {
  std::string text = "name = \"long\"\nduration_s = 3600.0\n";
  for (int k = 0; k < 5'000; ++k) {
    text += "[[move]]\nstart_s = " + std::to_string(k) + ".0\nto_deg = [" + std::to_string(k % 3) +
            ".0, 0.0]\n";
  }
  text.resize(text.find("start_s = 3590"));
  text.resize(text.rfind("[[move]]"));
  held_ = false;
  {
    RunCommand run(TargetsOf());
    EXPECT_TRUE(run.Start({{"command", "run"}, {"experiment", text}}, kRunClient, now_).is_null());
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    EXPECT_TRUE(run.planning());
  }
  EXPECT_THAT(stack_.TakeRequests(), IsEmpty());
}

TEST_F(RunCommandTest, TheOperatorGoesOnWhileAnExperimentIsJudged) {
  judging_held_ = true;
  held_ = false;
  EXPECT_TRUE(Start().is_null());
  for (int k = 0; k < 1'000; ++k) EXPECT_FALSE(Follow());
  EXPECT_TRUE(run_.planning());
  run_.Cancel();
  EXPECT_EQ(Follow()->json["refusal"], "cancelled");
  EXPECT_THAT(stack_.TakeRequests(), IsEmpty());
}

TEST_F(RunCommandTest, ACancelledPlanIsGivenUp) {
  judging_held_ = true;
  held_ = false;
  EXPECT_TRUE(Start().is_null());
  while (!judging_begun_) std::this_thread::yield();
  run_.Cancel();
  EXPECT_EQ(Follow()->json["refusal"], "cancelled");
  const auto latest = std::chrono::steady_clock::now() + kPlanWait;
  while (!given_up_ && std::chrono::steady_clock::now() < latest) std::this_thread::yield();
  EXPECT_TRUE(given_up_);
}

TEST_F(RunCommandTest, AnObjectionRefusesTheRunAndSaysHowToOverrideIt) {
  ObjectToTheExperiment();
  EXPECT_TRUE(Start().is_null());
  const std::optional<ClientAnswer> answer = FollowToTheEnd();
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->json["ok"], false);
  EXPECT_EQ(answer->json["refusal"], "predicted-trip");
  EXPECT_EQ(answer->json["error"], "it trips by bending-strain-1");
  EXPECT_THAT(answer->json.value("remedy", ""),
              AllOf(HasSubstr("gain-scheduled"), HasSubstr("--override-experiment REASON")));
  EXPECT_THAT(stack_.TakeRequests(), IsEmpty());
}

TEST_F(RunCommandTest, AnOverriddenObjectionIsRecordedWithItsReason) {
  ObjectToTheExperiment();
  EXPECT_TRUE(run_.Start({{"command", "run"},
                          {"experiment", kPlannedMove},
                          {"overrides", {{kExperimentCondition, "the stop is padded"}}}},
                         kRunClient, now_)
                  .is_null());
  EXPECT_FALSE(FollowToTheEnd()) << "the safety task answers";
  const std::vector<OperatorRequest> made = stack_.TakeRequests();
  ASSERT_EQ(made.size(), 1u);
  overrides_.Answered(now_.now_ns, Answered(RequestKind::kRun, made[0].number, Refusal::kNone));
  EXPECT_THAT(overrides_.Json().dump(),
              AllOf(HasSubstr("the stop is padded"), HasSubstr("it trips by bending-strain-1")));
}

TEST_F(RunCommandTest, AnOverrideWithoutAnObjectionIsNotUsed) {
  EXPECT_TRUE(run_.Start({{"command", "run"},
                          {"experiment", kPlannedMove},
                          {"overrides", {{kExperimentCondition, "to be sure"}}}},
                         kRunClient, now_)
                  .is_null());
  EXPECT_FALSE(FollowToTheEnd());
  const std::vector<OperatorRequest> made = stack_.TakeRequests();
  ASSERT_EQ(made.size(), 1u);
  overrides_.Answered(now_.now_ns, Answered(RequestKind::kRun, made[0].number, Refusal::kNone));
  EXPECT_THAT(overrides_.Json().dump(), Not(HasSubstr("to be sure")));
}

// Where the recorder reads it: in the announcement of the experiment.
TEST_F(RunCommandTest, ALabelGoesWithTheRunToItsLog) {
  const Json label = {{"name", "new gauge"}, {"note", "glued"}, {"tags", {"bench", "gauge-7"}}};
  EXPECT_TRUE(run_.Start({{"command", "run"}, {"experiment", kPlannedMove}, {"label", label}},
                         kRunClient, now_)
                  .is_null());
  FollowToTheEnd();
  RunEvent event;
  while (event.kind != "experiment") ASSERT_TRUE(events_.Pop(&event));
  const RunLabel announced = LabelOfAnnouncement(event);
  EXPECT_EQ(announced.name, "new gauge");
  EXPECT_EQ(announced.note, "glued");
  EXPECT_EQ(announced.tags, (std::vector<std::string>{"bench", "gauge-7"}));
}

TEST_F(RunCommandTest, AMalformedLabelIsRefusedByName) {
  const auto refusal = [this](const Json& label) {
    return MessageOf<RejectedError>([&] {
      run_.Start({{"command", "run"}, {"experiment", kPlannedMove}, {"label", label}}, kRunClient,
                 now_);
    });
  };
  for (const Json& label : {Json("text"), Json{{"name", 3}}, Json{{"tags", "bench"}},
                            Json{{"tags", {1}}}, Json{{"note", nullptr}}}) {
    EXPECT_THAT(refusal(label), HasSubstr("label: must be an object")) << label;
  }
  EXPECT_THAT(refusal({{"name", std::string(kLongestName + 1, 'x')}}),
              HasSubstr("the name is longer than 80 bytes"));
  EXPECT_THAT(refusal({{"note", "one\ntwo"}}), HasSubstr("the note contains a control character"));
  EXPECT_THAT(refusal({{"tags", {""}}}), HasSubstr("a tag is empty"));
  EXPECT_THAT(refusal({{"tags", std::vector<std::string>(kMostTags + 1, "x")}}),
              HasSubstr("has 21 tags, expected at most 20"));
  EXPECT_FALSE(run_.planning());
}

}  // namespace
}  // namespace flexarm
