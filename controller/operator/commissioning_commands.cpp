#include "controller/operator/commissioning_commands.h"

#include <utility>

#include "controller/operator/request_answers.h"

namespace flexarm {
namespace {

std::string EndLine(const nlohmann::json& answer) {
  const std::string command = answer.value("command", "");
  if (!answer.value("ok", false)) return command + ": " + answer.value("error", "failed");
  const std::string file = answer.value("calibration_file", "");
  return command + ": done" + (file.empty() ? "" : ", kept in " + file);
}

}  // namespace

CommissioningCommands::CommissioningCommands(const RigConfig& config, Targets targets)
    : targets_(std::move(targets)), commissioner_(config) {
  targets_.stack->Calibrate(commissioner_.calibration());
}

void CommissioningCommands::Start(const nlohmann::json& command, int client,
                                  const OperatorSnapshot& now) {
  CommissioningMotion motion = commissioner_.Start(command, now.permit.state);
  client_ = client;
  request_ = 0;
  if (motion.planned == nullptr) return;
  targets_.experiments->Load(now.now_ns, std::move(motion.planned), command["command"],
                             command.dump());
  request_ = targets_.requests->Ask(RequestKind::kRun, now.now_ns, motion.may_open);
}

std::optional<ClientAnswer> CommissioningCommands::TakeAnswer(const Permit& permit) {
  std::optional<nlohmann::json> answer = commissioner_.TakeAnswer();
  if (!answer) return std::nullopt;
  return Finish(std::move(*answer), permit);
}

std::optional<ClientAnswer> CommissioningCommands::Answered(const RequestAnswer& answer,
                                                            const Permit& permit) {
  const bool refused = answer.refusal != Refusal::kNone && answer.number == request_;
  if (!refused || !commissioner_.busy()) return std::nullopt;
  commissioner_.Abort();
  return Finish(RefusalJson(answer.kind, answer.refusal, answer.state), permit);
}

ClientAnswer CommissioningCommands::Finish(nlohmann::json answer, const Permit& permit) {
  answer["state"] = ToString(permit.state);
  if (permit.state == SafetyState::kTripped) answer["trip"] = ToString(permit.cause);
  targets_.stack->Calibrate(commissioner_.calibration());
  targets_.report(!answer.value("ok", false), EndLine(answer));
  return {.client = client_, .json = std::move(answer)};
}

}  // namespace flexarm
