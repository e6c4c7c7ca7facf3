#include "controller/operator/request_answers.h"

#include <nlohmann/json.hpp>

#include "controller/operator/cause_json.h"
#include "controller/tasks/loop_stack.h"  // of the safety machine: names and texts of refusals

namespace flexarm {
namespace {

std::string PresentText(const RequestAnswer& answer) {
  std::string text = RefusalText(answer.kind, answer.refusal, answer.state);
  if (answer.present == 0) return text;
  text += " Present:";
  for (const auto& name : NamesJson(answer.present)) {
    text += ' ';
    text += name.get_ref<const std::string&>();
  }
  text += '.';
  return text;
}

}  // namespace

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
  if (answer.kind == RequestKind::kRun && answer.refusal == Refusal::kNone) {
    json["run"] = answer.number;
  }
  const bool by_causes =
      answer.refusal == Refusal::kCauseRemains || answer.refusal == Refusal::kUnhealthy;
  if (by_causes && answer.present != 0) {
    json["present"] = NamesJson(answer.present);
    json["error"] = PresentText(answer);
  }
  return json;
}

std::string AnswerLine(const RequestAnswer& answer) {
  const std::string request = ToString(answer.kind);
  if (answer.refusal == Refusal::kNone) return request + ": accepted";
  return request + ": refused: " + RefusalText(answer.kind, answer.refusal, answer.state);
}

}  // namespace flexarm
