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
