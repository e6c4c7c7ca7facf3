#include "controller/operator/commissioning_commands.h"

#include <utility>

#include "controller/operator/request_answers.h"
#include "controller/types/named_rejection.h"

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
  Publish(0b11);
}

void CommissioningCommands::Publish(std::uint8_t unknown_before) {
  const std::uint8_t unknown = angles().unknown();
  targets_.stack->Calibrate(commissioner_.calibration());
  for (std::size_t joint = 0; joint < 2; ++joint) {
    const bool now = (unknown & ~unknown_before & 1U << joint) != 0;
    if (now) targets_.report(true, angles().Text(joint));
  }
}

void CommissioningCommands::Follow(const CountEpochs& epochs) {
  const std::uint8_t before = angles().unknown();
  commissioner_.Follow(epochs);
  if (angles().unknown() != before) Publish(before);
}

void CommissioningCommands::Take(const TickRecord& tick) {
  const std::uint8_t before = angles().unknown();
  const Calibration calibration = commissioner_.calibration();
  commissioner_.Take(tick);
  stepped_ = true;
  if (angles().unknown() != before || commissioner_.calibration() != calibration) Publish(before);
}

void CommissioningCommands::Start(const nlohmann::json& command, int client,
                                  const OperatorSnapshot& now) {
  if (targets_.requests->busy()) {
    throw NamedRejection("busy", RefusalText(RequestKind::kRun, Refusal::kBusy, now.permit.state));
  }
  CommissioningMotion motion = commissioner_.Start(command, now.permit.state, now.permit.reduced);
  client_ = client;
  command_ = command["command"];
  heard_ns_ = now.now_ns;
  request_ = 0;
  if (motion.planned == nullptr) return;
  request_ = targets_.experiments->AskForRun(now.now_ns, RequestTracker::kNoClient,
                                             {.planned = std::move(motion.planned),
                                              .name = command["command"],
                                              .text = command.dump(),
                                              .may_open = motion.may_open});
  commissioner_.Expect(request_);
}

std::optional<ClientAnswer> CommissioningCommands::TakeAnswer(const OperatorSnapshot& now) {
  if (std::exchange(stepped_, false)) heard_ns_ = now.now_ns;
  std::optional<nlohmann::json> answer = commissioner_.TakeAnswer();
  if (answer) return Finish(std::move(*answer), now.permit);
  if (!commissioner_.busy() || now.now_ns - heard_ns_ < kLoopStandsNs) return std::nullopt;
  commissioner_.Abort();
  return Finish({{"ok", false},
                 {"command", command_},
                 {"error",
                  "the control loop stands: it sent no sample for a second; see `flexarm status`, "
                  "and repeat the command when it runs"}},
                now.permit);
}

std::optional<ClientAnswer> CommissioningCommands::Answered(const RequestAnswer& answer,
                                                            const OperatorSnapshot& now) {
  if (answer.number != request_ || !commissioner_.busy()) return std::nullopt;
  if (answer.refusal == Refusal::kNone) {
    commissioner_.Granted(answer.number, now.now_ns);
    return std::nullopt;
  }
  commissioner_.Abort();
  return Finish(RefusalJson(answer.kind, answer.refusal, answer.state), now.permit);
}

ClientAnswer CommissioningCommands::Finish(nlohmann::json answer, const Permit& permit) {
  answer["state"] = ToString(permit.state);
  if (CauseLatched(permit.state)) answer["trip"] = ToString(permit.cause);
  Publish(angles().unknown());
  targets_.report(!answer.value("ok", false), EndLine(answer));
  return {.client = client_, .json = std::move(answer)};
}

}  // namespace flexarm
