// What the operator reads when a request is refused.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <iterator>
#include <string>

#include "tests/controller/safety/machine_facts.h"

namespace flexarm {
namespace {

using enum SafetyState;
using testing::EndsWith;
using testing::HasSubstr;

constexpr int kRefusals = static_cast<int>(Refusal::kTooLate) + 1;
constexpr auto kCorruptedRefusal = static_cast<Refusal>(kRefusals);

std::string Text(RequestKind request, SafetyState state, Refusal refusal = Refusal::kWrongState) {
  const char* text = RefusalText(request, refusal, state);
  EXPECT_NE(text, nullptr);
  return text != nullptr ? text : "";
}

TEST(RefusalText, IsASentenceForEachRefusalInEachState) {
  for (const RequestKind request : kEveryRequest) {
    for (int state = 0; state < kSafetyStates; ++state) {
      const auto in = static_cast<SafetyState>(state);
      EXPECT_EQ(Text(request, in, Refusal::kNone), "");
      for (int i = 1; i < kRefusals; ++i) {
        EXPECT_THAT(Text(request, in, static_cast<Refusal>(i)), EndsWith("."));
      }
    }
  }
  EXPECT_EQ(Text(RequestKind::kArm, kIdle, kCorruptedRefusal), "Unknown reason of refusal.");
}

TEST(RefusalText, SaysWhatEachRefusalIsAbout) {
  const struct {
    Refusal refusal;
    const char* about;
  } texts[] = {{Refusal::kNotAtRest, "Wait until it is at rest"},
               {Refusal::kCauseRemains, "Remove it"},
               {Refusal::kNoReset, "Press it at the rig"},
               {Refusal::kUnhealthy, "`flexarm status`"},
               {Refusal::kCancelled, "cancelled this planned request"},
               {Refusal::kBusy, "has not been answered yet"},
               {Refusal::kShuttingDown, "Start it again"},
               {Refusal::kTooLate, "too late for this run"},
               {Refusal::kRelayClosed, "the relay is welded"},
               {Refusal::kDrivesOff, "Check their supply"},
               {Refusal::kNotKept, "Make room"}};
  static_assert(std::size(texts) == kRefusals - 2, "but for none and wrong-state");
  for (const auto& [refusal, about] : texts) {
    EXPECT_THAT(Text(RequestKind::kArm, kIdle, refusal), HasSubstr(about));
  }
}

TEST(RefusalText, OfAWrongStateSaysHowToLeaveIt) {
  const struct {
    SafetyState state;
    RequestKind request;
    const char* text;
  } texts[] = {
      {kStarting, RequestKind::kArm, "still starting"},
      {kTripped, RequestKind::kArm, "press the reset button, then run `flexarm reset`"},
      {kFaultStopping, RequestKind::kArm, "press the reset button, then run `flexarm reset`"},
      {kFaultStopping, RequestKind::kReset, "being stopped"},
      {kTestingPump, RequestKind::kRun, "being armed"},
      {kTestingRelay, RequestKind::kReset, "being armed"},
      {kTestingPower, RequestKind::kReset, "being armed"},
      {kDisarming, RequestKind::kRun, "being disarmed"},
      {kArmed, RequestKind::kArm, "already armed"},
      {kIdle, RequestKind::kRun, "Run `flexarm arm` first"},
      {kRunning, RequestKind::kRun, "Run `flexarm stop` first"},
      {kIdle, RequestKind::kStop, "No experiment is running"},
      {kIdle, RequestKind::kDisarm, "The arm is not armed"},
      {kRunning, RequestKind::kDisarm, "Run `flexarm stop` first"},
      {kIdle, RequestKind::kReset, "no trip to reset"},
      {kArmed, RequestKind::kChange, "No experiment is running"},
      {kIdle, RequestKind::kNone, "Unknown request"},
      {kIdle, kCorruptedRequest, "Unknown request"},
  };
  for (const auto& [state, request, text] : texts) {
    EXPECT_THAT(Text(request, state), HasSubstr(text)) << ToString(state);
  }
}

TEST(RefusalText, RequestsAndRefusalsHaveTheirNames) {
  EXPECT_STREQ(ToString(RequestKind::kNone), "none");
  EXPECT_STREQ(ToString(RequestKind::kArm), "arm");
  EXPECT_STREQ(ToString(RequestKind::kRun), "run");
  EXPECT_STREQ(ToString(RequestKind::kStop), "stop");
  EXPECT_STREQ(ToString(RequestKind::kDisarm), "disarm");
  EXPECT_STREQ(ToString(RequestKind::kReset), "reset");
  EXPECT_STREQ(ToString(RequestKind::kChange), "change");
  EXPECT_STREQ(ToString(kCorruptedRequest), "corrupted");
  const char* const names[] = {"none",          "wrong-state", "not-at-rest", "cause-remains",
                               "no-reset",      "unhealthy",   "cancelled",   "busy",
                               "shutting-down", "drives-off",  "not-kept",    "relay-closed",
                               "too-late",      "corrupted"};
  static_assert(std::size(names) == kRefusals + 1);
  for (int i = 0; i <= kRefusals; ++i) {
    EXPECT_STREQ(ToString(static_cast<Refusal>(i)), names[i]);
  }
}

}  // namespace
}  // namespace flexarm
