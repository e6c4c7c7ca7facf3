#include "controller/operator/request_answers.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace flexarm {
namespace {

using Json = nlohmann::json;

constexpr RequestAnswer kAccepted{.number = 1'001,
                                  .kind = RequestKind::kArm,
                                  .refusal = Refusal::kNone,
                                  .state = SafetyState::kIdle,
                                  .present = 0};
constexpr RequestAnswer kRefused{.number = 1'002,
                                 .kind = RequestKind::kRun,
                                 .refusal = Refusal::kWrongState,
                                 .state = SafetyState::kIdle,
                                 .present = 0};

TEST(RequestAnswers, AnAcceptedRequestIsAnsweredWithTheStateOfNow) {
  EXPECT_EQ(AnswerJson(kAccepted, SafetyState::kArmed),
            Json({{"ok", true}, {"command", "arm"}, {"state", "Armed"}}));
  EXPECT_EQ(AnswerLine(kAccepted), "arm: accepted");
}

TEST(RequestAnswers, ARunHasItsNumber) {
  RequestAnswer granted = kAccepted;
  granted.kind = RequestKind::kRun;
  EXPECT_EQ(AnswerJson(granted, SafetyState::kRunning)["run"], 1'001);
  EXPECT_FALSE(AnswerJson(kRefused, SafetyState::kIdle).contains("run"));
}

TEST(RequestAnswers, ACauseThatRemainsIsNamed) {
  RequestAnswer refused = kRefused;
  refused.kind = RequestKind::kReset;
  refused.refusal = Refusal::kCauseRemains;
  refused.state = SafetyState::kTripped;
  refused.present = CauseBit(TripCause::kLimitSwitch1High) | CauseBit(TripCause::kSoftLimit1);
  const Json answer = AnswerJson(refused, SafetyState::kTripped);
  EXPECT_EQ(answer["present"], Json({"limit-switch-1-high", "soft-limit-1"}));
  const std::string error = answer["error"];
  EXPECT_NE(error.find("Present: limit-switch-1-high soft-limit-1."), std::string::npos) << error;
}

TEST(RequestAnswers, ARefusalIsExplainedByTheStateInWhichItWasJudged) {
  const std::string why = "The arm is not armed. Run `flexarm arm` first.";  // of Idle
  EXPECT_EQ(AnswerJson(kRefused, SafetyState::kArmed), Json({{"ok", false},
                                                             {"command", "run"},
                                                             {"state", "Armed"},
                                                             {"refusal", "wrong-state"},
                                                             {"error", why}}));
  EXPECT_EQ(RefusalJson(RequestKind::kRun, Refusal::kWrongState, SafetyState::kIdle),
            Json({{"ok", false}, {"refusal", "wrong-state"}, {"error", why}}));
  EXPECT_EQ(AnswerLine(kRefused), "run: refused: " + why);
}

}  // namespace
}  // namespace flexarm
