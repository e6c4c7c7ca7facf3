#include "controller/operator/arm_command.h"

#include <chrono>
#include <exception>
#include <utility>

#include "controller/operator/log_condition.h"
#include "controller/operator/request_answers.h"

namespace flexarm {
namespace {

nlohmann::json Refused(Refusal refusal, SafetyState state) {
  nlohmann::json json = RefusalJson(RequestKind::kArm, refusal, state);
  json["command"] = ToString(RequestKind::kArm);
  json["state"] = ToString(state);
  return json;
}

nlohmann::json Refused(const UnmetCondition& condition, SafetyState state) {
  return {{"ok", false},
          {"refusal", condition.refusal},
          {"error", condition.found},
          {"remedy", condition.remedy},
          {"command", ToString(RequestKind::kArm)},
          {"state", ToString(state)}};
}

ArmVerdict Failed(const std::string& what) {
  return {.result = ArmVerdict::Result::kFailed,
          .findings = {{.name = "host-check",
                        .text = "the check itself failed: " + what,
                        .remedy = "run `flexarm check-host` on this machine"}}};
}

}  // namespace

ArmCommand::ArmCommand(ArmChecks checks, Targets targets)
    : checks_(std::move(checks)), targets_(std::move(targets)) {}

void ArmCommand::BeginCheck() {
  if (checks_.simulated || check_.valid()) return;
  if (!checks_.check_host) {
    host_ = Failed("the daemon has none");
    ReportHost();
    return;
  }
  check_ = std::async(std::launch::async, checks_.check_host);
}

void ArmCommand::TakeCheck() {
  if (!check_.valid() || check_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) {
    return;
  }
  try {
    host_ = check_.get();
  } catch (const std::exception& error) {
    host_ = Failed(error.what());
  }
  ReportHost();
}

// Each verdict once: most commands find what the one before found.
void ArmCommand::ReportHost() {
  if (has_reported_ && reported_ == host_.findings) return;
  has_reported_ = true;
  reported_ = host_.findings;
  if (host_.result == ArmVerdict::Result::kPassed) targets_.report(false, "host: ready");
  for (const Finding& finding : host_.findings) {
    targets_.report(!finding.advice, std::string(finding.advice ? "host, advice: " : "host: ") +
                                         finding.name + ": " + finding.text +
                                         "; remedy: " + finding.remedy);
  }
}

nlohmann::json ArmCommand::Start(const nlohmann::json& command, int client,
                                 const OperatorSnapshot& now) {
  Waiting asked{.client = client,
                .overrides = OverridesOf(command, {kHostCondition, kDesignCondition}),
                .since_ns = now.now_ns};
  if (targets_.requests->busy() || waits_) return Refused(Refusal::kBusy, now.permit.state);
  const bool may_arm = now.permit.state == SafetyState::kIdle;
  if (may_arm && targets_.files != nullptr) targets_.files->Want();
  if (checks_.simulated && !(may_arm && AwaitsFile())) return Decide(asked, now);
  if (!checks_.simulated) host_.result = ArmVerdict::Result::kChecking;
  BeginCheck();
  waits_ = std::move(asked);
  return nullptr;
}

bool ArmCommand::AwaitsFile() const {
  if (targets_.files == nullptr) return false;
  const LogStatus log = targets_.files->status();
  return log.required && !log.answered;
}

std::optional<ClientAnswer> ArmCommand::Follow(const OperatorSnapshot& now) {
  if (!has_reported_ && !waits_) BeginCheck();  // the one at the start
  TakeCheck();
  if (!waits_) return std::nullopt;
  const bool late = now.now_ns - waits_->since_ns > kLongestCheckNs;
  const bool file_comes = now.permit.state == SafetyState::kIdle && AwaitsFile();
  if ((check_.valid() || file_comes) && !late && !cancelled_) return std::nullopt;
  const Waiting command = std::move(*waits_);
  waits_.reset();
  nlohmann::json answer = std::exchange(cancelled_, false)
                              ? Refused(Refusal::kCancelled, now.permit.state)
                              : Decide(command, now);
  if (answer.is_null()) return std::nullopt;
  return ClientAnswer{.client = command.client, .json = std::move(answer)};
}

nlohmann::json ArmCommand::Decide(const Waiting& command, const OperatorSnapshot& now) {
  const SafetyState state = now.permit.state;
  std::vector<UnmetCondition> unmet = UnmetToArm(host_, checks_.design, checks_.simulated);
  if (state == SafetyState::kIdle) {
    if (const auto no_log = UnmetLog(targets_.files)) unmet.push_back(*no_log);
  }
  const ConditionDecision decision = Judge(unmet, command.overrides);
  if (decision.refused != nullptr) {
    if (state != SafetyState::kIdle) return Refused(Refusal::kWrongState, state);
    return Refused(*decision.refused, state);
  }
  const RequestTracker::Asked asked =
      targets_.requests->Ask(RequestKind::kArm, now.now_ns, command.client);
  if (asked.number == 0) {
    nlohmann::json refused = Refused(asked.refusal, state);
    if (!asked.why.empty()) refused["error"] = asked.why + ". " + std::string(refused["error"]);
    return refused;
  }
  targets_.overrides->Asked(asked.number, decision.used);
  return nullptr;
}

std::string ArmCommand::WhyNotUnattended() const {
  const ArmVerdict ready{.result = ArmVerdict::Result::kPassed};
  const std::vector<UnmetCondition> unmet = UnmetToArm(ready, checks_.design, checks_.simulated);
  return unmet.empty() ? std::string() : unmet.front().found + "; " + unmet.front().remedy;
}

nlohmann::json ArmCommand::HostStatus() const {
  return checks_.simulated ? nlohmann::json(nullptr) : HostJson(host_);
}

}  // namespace flexarm
