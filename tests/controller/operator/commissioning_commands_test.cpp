#include "controller/operator/commissioning_commands.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "controller/types/rejected_error.h"
#include "tests/controller/operator/operator_parts.h"

namespace flexarm {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

class CommissioningCommandsTest : public OperatorParts {
 protected:
  CommissioningCommandsTest() : OperatorParts(ShippedRig({"log.directory='" + Folder() + "'"})) {}
  ~CommissioningCommandsTest() override { std::filesystem::remove_all(Folder()); }

  static std::string Folder() {
    return testing::TempDir() + "commissioning_commands_" +
           testing::UnitTest::GetInstance()->current_test_info()->name();
  }

  std::optional<ClientAnswer> AnswerOf(std::uint32_t number, Refusal refusal) {
    return commissioning_.Answered(OperatorParts::Answered(RequestKind::kRun, number, refusal),
                                   now_);
  }

  // Still steps, as many as a measurement of the config takes, but the last.
  void MeasureButOne() {
    TickRecord tick{};
    tick.input.safety_state = SafetyState::kIdle;
    tick.output.counters_used = 0b1111;
    for (std::size_t i = 0; i < config_.sensors.strain.size(); ++i) {
      tick.input.frame.strain[i] = 3;
      tick.input.frame.strain_valid |= 1u << i;
    }
    const double ticks = config_.commissioning.measure_s / kPeriod_s;
    for (int k = 1; k < static_cast<int>(ticks); ++k) commissioning_.Take(tick);
    last_ = tick;
  }

  TickRecord last_{};
};

TEST_F(CommissioningCommandsTest, AMotionIsARunThatIsAskedForWithItsSwitch) {
  const Json home{{"command", "home"}, {"joint", 2}, {"side", "high"}};
  commissioning_.Start(home, 7, now_);
  const std::vector<OperatorRequest> made = stack_.TakeRequests();
  ASSERT_EQ(made.size(), 1u);
  EXPECT_EQ(made[0].kind, RequestKind::kRun);
  EXPECT_EQ(made[0].run.experiment->mode, LoopMode::kRegulate);
  EXPECT_EQ(made[0].run.may_open, LineBit(Line::kLimit2High)) << "the switch that it looks for";
  Answered(RequestKind::kRun, made[0].number, Refusal::kNone);
  const std::vector<RunEvent> logged = TakeEvents(&events_);
  ASSERT_EQ(logged.size(), 1u);
  EXPECT_EQ(logged[0].name, "home");
  EXPECT_EQ(Json::parse(logged[0].text), home);
}

// A run that is not answered yet could be the motion's, and the other way round.
TEST_F(CommissioningCommandsTest, NothingBeginsWhileARequestIsInFlight) {
  const std::uint32_t arm = requests_.Ask(RequestKind::kArm, 0, 6).number;
  EXPECT_THROW(commissioning_.Start({{"command", "pluck"}}, 7, now_), RejectedError);
  EXPECT_EQ(stack_.TakeRequests().size(), 1u);
  Answered(RequestKind::kArm, arm, Refusal::kWrongState);
  EXPECT_NO_THROW(commissioning_.Start({{"command", "pluck"}}, 7, now_));
}

TEST_F(CommissioningCommandsTest, ARefusedMotionIsAnsweredToItsClientAndFreesTheNext) {
  commissioning_.Start({{"command", "pluck"}}, 7, now_);
  const std::uint32_t number = stack_.TakeRequests().at(0).number;
  EXPECT_FALSE(AnswerOf(number - 1, Refusal::kWrongState)) << "of another request";
  now_.permit.state = SafetyState::kTripped;
  now_.permit.cause = TripCause::kEmergencyStop;
  const std::optional<ClientAnswer> answer = AnswerOf(number, Refusal::kWrongState);
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->client, 7);
  EXPECT_EQ(answer->json["ok"], false);
  EXPECT_EQ(answer->json["refusal"], "wrong-state");
  EXPECT_EQ(answer->json["state"], "Tripped");
  EXPECT_EQ(answer->json["trip"], "emergency-stop");
  EXPECT_FALSE(AnswerOf(number, Refusal::kWrongState)) << "once";
  now_.permit.state = SafetyState::kArmed;
  EXPECT_NO_THROW(commissioning_.Start({{"command", "pluck"}}, 8, now_));
}

TEST_F(CommissioningCommandsTest, AGrantedMotionHasOnlyBegun) {
  commissioning_.Start({{"command", "pluck"}}, 7, now_);
  EXPECT_FALSE(AnswerOf(stack_.TakeRequests().at(0).number, Refusal::kNone));
}

// A control thread that hangs sends no steps: the client would wait for ever.
TEST_F(CommissioningCommandsTest, AMeasurementEndsWhenTheLoopStands) {
  now_.permit.state = SafetyState::kIdle;
  commissioning_.Start({{"command", "tare"}}, 9, now_);
  MeasureButOne();
  EXPECT_FALSE(commissioning_.TakeAnswer(now_));
  now_.now_ns += CommissioningCommands::kLoopStandsNs - 1;
  EXPECT_FALSE(commissioning_.TakeAnswer(now_));
  now_.now_ns += 1;
  const std::optional<ClientAnswer> answer = commissioning_.TakeAnswer(now_);
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->client, 9);
  EXPECT_EQ(answer->json["ok"], false);
  EXPECT_EQ(answer->json["command"], "tare");
  EXPECT_NE(answer->json["error"].get<std::string>().find("the control loop stands"),
            std::string::npos);
  EXPECT_FALSE(commissioning_.TakeAnswer(now_)) << "once";
  EXPECT_NO_THROW(commissioning_.Start({{"command", "tare"}}, 8, now_));
}

TEST_F(CommissioningCommandsTest, AMeasurementIsAnsweredToItsClientWhenItHasEnded) {
  now_.permit.state = SafetyState::kIdle;
  commissioning_.Start({{"command", "tare"}}, 9, now_);
  EXPECT_TRUE(stack_.TakeRequests().empty()) << "nothing moves";
  MeasureButOne();
  EXPECT_FALSE(commissioning_.TakeAnswer(now_));
  commissioning_.Take(last_);
  const std::optional<ClientAnswer> answer = commissioning_.TakeAnswer(now_);
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->client, 9);
  EXPECT_EQ(answer->json["ok"], true) << answer->json;
  EXPECT_EQ(answer->json["command"], "tare");
  EXPECT_EQ(answer->json["state"], "Idle");
  EXPECT_FALSE(commissioning_.TakeAnswer(now_)) << "once";
  ASSERT_EQ(journal_.lines.size(), 1u);
  EXPECT_FALSE(journal_.lines[0].first);
  EXPECT_THAT(journal_.lines[0].second, HasSubstr("tare: done, kept in " + Folder()));
}

TEST_F(CommissioningCommandsTest, AnAngleThatBecomesUnknownIsReportedOnceAndRefusesARun) {
  commissioning_.Follow(CountEpochs{});
  EXPECT_EQ(commissioning_.WhyNoRun(), "");
  for (int k = 0; k < 3; ++k) commissioning_.Follow(CountEpochs{0, 1, 0, 0});
  const std::string text = commissioning_.angles().Text(1);
  EXPECT_THAT(text, HasSubstr("The angle of joint 2 is unknown: its encoder lost power"));
  EXPECT_EQ(commissioning_.WhyNoRun(), text);
  ASSERT_EQ(journal_.lines.size(), 1u);
  EXPECT_TRUE(journal_.lines[0].first);
  EXPECT_EQ(journal_.lines[0].second, text);
}

TEST_F(CommissioningCommandsTest, ALossOfCountAnswersTheCommandThatItSpoils) {
  now_.permit.state = SafetyState::kIdle;
  commissioning_.Start({{"command", "zero"}}, 9, now_);
  MeasureButOne();
  commissioning_.Follow(CountEpochs{1, 0, 0, 0});
  commissioning_.Take(last_);
  const std::optional<ClientAnswer> answer = commissioning_.TakeAnswer(now_);
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->client, 9);
  EXPECT_EQ(answer->json["ok"], false);
  EXPECT_EQ(commissioning_.angles().unknown(), 0b01) << "it has zeroed nothing";
}

TEST_F(CommissioningCommandsTest, AMeasurementThatFailsIsAnError) {
  now_.permit.state = SafetyState::kIdle;
  commissioning_.Start({{"command", "zero"}}, 9, now_);
  MeasureButOne();
  last_.input.safety_state = SafetyState::kArmed;
  commissioning_.Take(last_);
  const std::optional<ClientAnswer> answer = commissioning_.TakeAnswer(now_);
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->json["ok"], false);
  ASSERT_EQ(journal_.lines.size(), 1u);
  EXPECT_TRUE(journal_.lines[0].first);
  EXPECT_THAT(journal_.lines[0].second, HasSubstr("zero: the arm left the state Idle"));
}

TEST_F(CommissioningCommandsTest, ACommandThatIsRefusedLeavesTheOneThatGoesOn) {
  now_.permit.state = SafetyState::kIdle;
  commissioning_.Start({{"command", "tare"}}, 9, now_);
  EXPECT_THROW(commissioning_.Start({{"command", "zero"}}, 10, now_), RejectedError);
  MeasureButOne();
  commissioning_.Take(last_);
  const std::optional<ClientAnswer> answer = commissioning_.TakeAnswer(now_);
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->client, 9);
  EXPECT_EQ(answer->json["command"], "tare");
}

}  // namespace
}  // namespace flexarm
