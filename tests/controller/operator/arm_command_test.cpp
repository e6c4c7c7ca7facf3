#include "controller/operator/arm_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <stdexcept>
#include <thread>

#include "controller/types/rejected_error.h"
#include "tests/controller/latch/latch_folder.h"
#include "tests/controller/operator/operator_records.h"
#include "tests/controller/operator/still_stack.h"
#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;
using testing::IsEmpty;
using Result = ArmVerdict::Result;

constexpr int kArmClient = 7;
const Json kArmLine{{"command", "arm"}};
const Json kArmAnyway{{"command", "arm"}, {"overrides", {{"host", "emulated machine"}}}};

ArmVerdict NotReady() {
  return {.result = Result::kFailed,
          .findings = {{.name = "preempt-rt", .text = "none", .remedy = "install it"}}};
}

// A wired rig in Idle, whose machine is checked when the test lets the check end.
class ArmCommandTest : public testing::Test {
 protected:
  ArmCommandTest() {
    now_.permit.state = SafetyState::kIdle;
    latch_.Open();
  }

  ArmCommand& Make(Result design = Result::kPassed) {
    arm_ = std::make_unique<ArmCommand>(
        ArmChecks{.design = {.result = design, .findings = {}},
                  .simulated = simulated_,
                  .check_host = [this] { return Check(); }},
        ArmCommand::Targets{
            .requests = &requests_, .overrides = &overrides_, .report = journal_.Report()});
    return *arm_;
  }
  ~ArmCommandTest() override { held_ = false; }

  // Periods of the operator until the command is answered or asked for.
  std::optional<ClientAnswer> FollowUntilDecided() {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (std::chrono::steady_clock::now() < end) {
      now_.now_ns += kMs;
      std::optional<ClientAnswer> answer = arm_->Follow(now_);
      if (answer || requests_.busy()) return answer;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    ADD_FAILURE() << "never decided";
    return std::nullopt;
  }

  ArmVerdict Check() {
    while (held_) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ++checks_;
    if (throws_) throw std::runtime_error("no /proc");
    return verdict_;
  }

  StillStack stack_;
  EventQueue events_{8};
  RecordedJournal journal_;
  LatchFolder folder_;
  TripLatch latch_{folder_.path(), "/runs", [](bool, const std::string&) {}};
  RequestTracker requests_{&stack_, &latch_};
  OverrideRecord overrides_{&events_, journal_.Report()};
  OperatorSnapshot now_;
  ArmVerdict verdict_{.result = Result::kPassed, .findings = {}};  // of the check
  std::atomic<bool> held_{false};
  std::atomic<int> checks_{0};
  bool throws_ = false, simulated_ = false;
  std::unique_ptr<ArmCommand> arm_;  // last: it waits for its check
};

TEST_F(ArmCommandTest, OnAGoodMachineTheSafetyTaskIsAsked) {
  EXPECT_TRUE(Make().Start(kArmLine, kArmClient, now_).is_null());
  EXPECT_THAT(stack_.TakeRequests(), IsEmpty()) << "not before the check";
  EXPECT_FALSE(FollowUntilDecided());
  const std::vector<OperatorRequest> made = stack_.TakeRequests();
  ASSERT_EQ(made.size(), 1u);
  EXPECT_EQ(made[0].kind, RequestKind::kArm);
  EXPECT_EQ(arm_->HostStatus()["verdict"], "ready");
}

TEST_F(ArmCommandTest, OnABadMachineItIsRefusedAndTheJournalSaysWhy) {
  verdict_ = NotReady();
  EXPECT_TRUE(Make().Start(kArmLine, kArmClient, now_).is_null());
  const std::optional<ClientAnswer> answer = FollowUntilDecided();
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->client, kArmClient);
  EXPECT_EQ(answer->json["ok"], false);
  EXPECT_EQ(answer->json["refusal"], "host-not-ready");
  EXPECT_EQ(answer->json["command"], "arm");
  EXPECT_THAT(answer->json.value("error", ""), HasSubstr("preempt-rt"));
  EXPECT_THAT(answer->json.value("remedy", ""), HasSubstr("install it"));
  EXPECT_THAT(stack_.TakeRequests(), IsEmpty());
  EXPECT_GE(journal_.Find("host: preempt-rt: none; remedy: install it"), 0);
}

TEST_F(ArmCommandTest, AnOverrideIsRecordedWithTheRequestThatItAllowed) {
  verdict_ = NotReady();
  EXPECT_TRUE(Make().Start(kArmAnyway, kArmClient, now_).is_null());
  EXPECT_FALSE(FollowUntilDecided());
  const std::vector<OperatorRequest> made = stack_.TakeRequests();
  ASSERT_EQ(made.size(), 1u);
  overrides_.Answered(now_.now_ns, {.number = made[0].number,
                                    .kind = RequestKind::kArm,
                                    .refusal = Refusal::kNone,
                                    .state = SafetyState::kIdle,
                                    .present = 0});
  ASSERT_EQ(overrides_.in_force().size(), 1u);
  EXPECT_EQ(overrides_.in_force()[0].reason, "emulated machine");
  EXPECT_THAT(overrides_.in_force()[0].found, HasSubstr("preempt-rt"));
}

TEST_F(ArmCommandTest, TheMachineIsCheckedAtTheStartAndAgainForEachCommand) {
  Make();
  EXPECT_EQ(arm_->HostStatus()["verdict"], "checking");
  for (int i = 0; i < 10'000 && journal_.Find("host: ready") < 0; ++i) {
    arm_->Follow(now_);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_EQ(checks_, 1);
  verdict_ = NotReady();  // since then another kernel was started
  EXPECT_TRUE(arm_->Start(kArmLine, kArmClient, now_).is_null());
  EXPECT_TRUE(FollowUntilDecided());
  EXPECT_EQ(checks_, 2);
  EXPECT_EQ(arm_->HostStatus()["verdict"], "not-ready");
}

TEST_F(ArmCommandTest, ACheckThatTakesTooLongLeavesTheMachineUnknown) {
  held_ = true;
  EXPECT_TRUE(Make().Start(kArmLine, kArmClient, now_).is_null());
  EXPECT_FALSE(arm_->Follow(now_));
  now_.now_ns += ArmCommand::kLongestCheckNs + kMs;
  const std::optional<ClientAnswer> answer = arm_->Follow(now_);
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->json["refusal"], "host-checking");
  EXPECT_THAT(stack_.TakeRequests(), IsEmpty());
}

TEST_F(ArmCommandTest, AStopCancelsTheCommandThatWaits) {
  held_ = true;
  EXPECT_TRUE(Make().Start(kArmLine, kArmClient, now_).is_null());
  arm_->Cancel();
  const std::optional<ClientAnswer> answer = arm_->Follow(now_);
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->json["refusal"], "cancelled");
  held_ = false;
  EXPECT_TRUE(arm_->Start(kArmLine, kArmClient, now_).is_null()) << "the next is not cancelled";
  EXPECT_FALSE(FollowUntilDecided());
  EXPECT_EQ(stack_.TakeRequests().size(), 1u);
}

TEST_F(ArmCommandTest, ASecondCommandThatComesMeanwhileIsBusy) {
  held_ = true;
  EXPECT_TRUE(Make().Start(kArmLine, kArmClient, now_).is_null());
  EXPECT_EQ(arm_->Start(kArmLine, kArmClient + 1, now_)["refusal"], "busy");
  held_ = false;
}

TEST_F(ArmCommandTest, ACheckThatFailsOrIsMissingRefuses) {
  throws_ = true;
  EXPECT_TRUE(Make().Start(kArmLine, kArmClient, now_).is_null());
  std::optional<ClientAnswer> answer = FollowUntilDecided();
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->json["refusal"], "host-not-ready");
  EXPECT_THAT(answer->json.value("error", ""), HasSubstr("no /proc"));

  ArmCommand none({.design = {.result = Result::kPassed, .findings = {}}},
                  {.requests = &requests_, .overrides = &overrides_, .report = journal_.Report()});
  EXPECT_TRUE(none.Start(kArmLine, kArmClient, now_).is_null());
  answer = none.Follow(now_);
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->json["refusal"], "host-not-ready");
  EXPECT_THAT(stack_.TakeRequests(), IsEmpty());
}

TEST_F(ArmCommandTest, InAnotherStateThanIdleARefusalSaysThat) {
  verdict_ = NotReady();
  now_.permit.state = SafetyState::kTripped;
  EXPECT_TRUE(Make().Start(kArmLine, kArmClient, now_).is_null());
  const std::optional<ClientAnswer> answer = FollowUntilDecided();
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->json["refusal"], "wrong-state");
  EXPECT_THAT(stack_.TakeRequests(), IsEmpty());
}

TEST_F(ArmCommandTest, AMalformedOverrideIsRefusedBeforeAnythingIsChecked) {
  const Json command{{"command", "arm"}, {"overrides", {{"host", "a\nb"}}}};
  EXPECT_THROW(Make().Start(command, kArmClient, now_), RejectedError);
  EXPECT_THROW(arm_->Start({{"overrides", {{"switches", "x"}}}}, kArmClient, now_), RejectedError);
  EXPECT_THAT(stack_.TakeRequests(), IsEmpty());
}

TEST_F(ArmCommandTest, ASimulatedArmIsJudgedByItsDesignAtOnce) {
  simulated_ = true;
  EXPECT_EQ(Make(Result::kFailed).Start(kArmLine, kArmClient, now_)["refusal"], "design-rejected");
  EXPECT_THAT(arm_->WhyNotUnattended(), HasSubstr("rejected"));
  const Json insists{{"overrides", {{"design", "I want it"}, {"host", "and this"}}}};
  EXPECT_EQ(arm_->Start(insists, kArmClient, now_)["refusal"], "design-rejected");
  EXPECT_THAT(stack_.TakeRequests(), IsEmpty());
  EXPECT_TRUE(arm_->HostStatus().is_null());
  EXPECT_TRUE(Make(Result::kForced).Start(kArmLine, kArmClient, now_).is_null());
  EXPECT_EQ(stack_.TakeRequests().size(), 1u);
  EXPECT_EQ(arm_->WhyNotUnattended(), "");
  EXPECT_EQ(checks_, 0);
}

}  // namespace
}  // namespace flexarm
