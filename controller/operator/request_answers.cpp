#include "controller/operator/request_answers.h"

#include <nlohmann/json.hpp>

#include "controller/tasks/loop_stack.h"  // of the safety machine: names and texts of refusals

namespace flexarm {

nlohmann::json RefusalJson(RequestKind request, Refusal refusal, SafetyState state) {
  return {{"ok", false},
          {"refusal", ToString(refusal)},
          {"error", RefusalText(request, refusal, state)}};
}

nlohmann::json AnswerJson(const RequestAnswer& answer, SafetyState state_now) {
  nlohmann::json json = answer.refusal == Refusal::kNone
                            ? nlohmann::json{{"ok", true}}
                            : RefusalJson(answer.kind, answer.refusal, answer.state);
  json["command"] = ToString(answer.kind);
  json["state"] = ToString(state_now);
  return json;
}

std::string AnswerLine(const RequestAnswer& answer) {
  const std::string request = ToString(answer.kind);
  if (answer.refusal == Refusal::kNone) return request + ": accepted";
  return request + ": refused: " + RefusalText(answer.kind, answer.refusal, answer.state);
}

}  // namespace flexarm
