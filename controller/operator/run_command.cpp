#include "controller/operator/run_command.h"

#include <cmath>
#include <utility>

#include "controller/operator/change_command.h"
#include "controller/operator/command_text.h"
#include "controller/operator/log_condition.h"
#include "controller/operator/request_answers.h"
#include "controller/runlog/run_label.h"
#include "controller/types/rejected_error.h"

namespace flexarm {
namespace {

std::array<double, 2> HubsOf(const OperatorSnapshot& now) {
  return {now.tick.output.angle_rad[0], now.tick.output.angle_rad[1]};
}

nlohmann::json Refused(Refusal refusal, const OperatorSnapshot& now) {
  nlohmann::json json = RefusalJson(RequestKind::kRun, refusal, now.permit.state);
  json["command"] = ToString(RequestKind::kRun);
  json["state"] = ToString(now.permit.state);
  return json;
}

nlohmann::json Refused(const std::string& refusal, const std::string& error,
                       const std::string& remedy) {
  nlohmann::json json{{"ok", false},
                      {"refusal", refusal},
                      {"command", ToString(RequestKind::kRun)},
                      {"error", error}};
  if (!remedy.empty()) json["remedy"] = remedy;
  return json;
}

RunLabel LabelOf(const nlohmann::json& command) {
  const auto given = command.find("label");
  if (given == command.end()) return {};
  const std::optional<RunLabel> label = LabelOfJson(*given);
  if (!label) {
    throw RejectedError(
        "label: must be an object of name and note, texts, and tags, a list of texts");
  }
  if (const std::string problem = ProblemOfLabel(*label); !problem.empty()) {
    throw RejectedError("label: " + problem);
  }
  return *label;
}

}  // namespace

nlohmann::json RunCommand::WhyNot(const std::vector<Override>& overrides,
                                  const OperatorSnapshot& now,
                                  const std::optional<UnmetCondition>& of_plan,
                                  std::vector<Override>* used) const {
  if (now.shutting_down) return Refused(Refusal::kShuttingDown, now);
  if (now.permit.state != SafetyState::kArmed) return Refused(Refusal::kWrongState, now);
  if (const std::string why = targets_.commissioning->WhyNoRun(); !why.empty()) {
    if (targets_.commissioning->NeedsPluck()) return Refused("not-plucked", why, "then run");
    return Refused("angle-unknown", why, "then run");
  }
  std::vector<UnmetCondition> unmet = targets_.switches->UnmetToRun();
  if (const auto no_log = UnmetLog(targets_.files)) unmet.push_back(*no_log);
  if (of_plan) {
    unmet.push_back(*of_plan);
    unmet.back().remedy +=
        "; or, on your own responsibility, `flexarm run --override-experiment REASON`";
  }
  ConditionDecision decision = Judge(unmet, overrides);
  if (decision.refused != nullptr) {
    return Refused(decision.refused->refusal, decision.refused->found, decision.refused->remedy);
  }
  *used = std::move(decision.used);
  return nullptr;
}

nlohmann::json RunCommand::Start(const nlohmann::json& command, int client,
                                 const OperatorSnapshot& now) {
  std::vector<Override> used;
  std::vector<Override> overrides =
      OverridesOf(command, {kSwitchesCondition, kExperimentCondition});
  RunLabel label = LabelOf(command);
  if (nlohmann::json refused = WhyNot(overrides, now, {}, &used); !refused.is_null()) {
    return refused;
  }
  const std::array<double, 2> start_rad = HubsOf(now);
  const double speed = SpeedOf(command);
  planner_.Begin([this, start_rad, overrides, speed, text = TextOf(command, "experiment", ""),
                  name = TextOf(command, "name", "experiment")](const std::stop_token& stop) {
    return Plan(AtSpeed(targets_.parse_experiment(text, name), speed), start_rad, overrides, stop);
  });
  waits_ = Waiting{.client = client,
                   .overrides = std::move(overrides),
                   .start_rad = start_rad,
                   .label = std::move(label)};
  return nullptr;
}

// What is judged comes first: its refusal says which law would do.
ExperimentLoader::Order RunCommand::Plan(const Experiment& experiment,
                                         const std::array<double, 2>& start_rad,
                                         const std::vector<Override>& overrides,
                                         const std::stop_token& stop) const {
  std::optional<UnmetCondition> unmet;
  if (targets_.judge_experiment) unmet = targets_.judge_experiment(experiment, start_rad, stop);
  if (unmet && Judge({*unmet}, overrides).refused != nullptr) {
    return {.planned = nullptr, .name = {}, .text = {}, .unmet = std::move(unmet)};
  }
  ExperimentLoader::Order order = targets_.experiments->Plan(experiment, start_rad, stop);
  order.unmet = std::move(unmet);
  return order;
}

std::optional<ClientAnswer> RunCommand::Follow(const OperatorSnapshot& now,
                                               const std::function<bool(int client)>& is_there) {
  if (!waits_) return std::nullopt;
  const bool cancelled = cancelled_ || now.shutting_down || !is_there(waits_->client);
  std::optional<ExperimentPlanner::Outcome> planned;
  if (!cancelled) {
    if (targets_.experiments->busy()) return std::nullopt;  // a reset is not answered yet
    planned = planner_.Take(targets_.plan_wait);
    if (!planned) return std::nullopt;
  }
  Waiting command = std::move(*waits_);
  waits_.reset();
  const int client = command.client;
  nlohmann::json answer;
  if (cancelled) {
    planner_.Cancel();
    answer = Refused(now.shutting_down ? Refusal::kShuttingDown : Refusal::kCancelled, now);
  } else {
    answer = Decide(std::move(command), std::move(*planned), now);
  }
  cancelled_ = false;
  if (answer.is_null()) return std::nullopt;
  answer["state"] = ToString(now.permit.state);
  return ClientAnswer{.client = client, .json = std::move(answer)};
}

nlohmann::json RunCommand::Decide(Waiting command, ExperimentPlanner::Outcome planned,
                                  const OperatorSnapshot& now) {
  if (!planned.order) return Refused("experiment-refused", planned.problem, "");
  std::vector<Override> used;
  const std::optional<UnmetCondition>& unmet = planned.order->unmet;
  if (nlohmann::json refused = WhyNot(command.overrides, now, unmet, &used); !refused.is_null()) {
    return refused;
  }
  const std::array<double, 2> hub_rad = HubsOf(now);
  for (std::size_t joint = 0; joint < 2; ++joint) {
    if (std::fabs(hub_rad[joint] - command.start_rad[joint]) <= kMoved_rad) continue;
    return Refused("arm-moved", "the arm was moved while its run was planned",
                   "repeat the command");
  }
  planned.order->label = std::move(command.label);
  const std::uint32_t number =
      targets_.experiments->AskForRun(now.now_ns, command.client, std::move(*planned.order));
  if (number == 0) return Refused(Refusal::kBusy, now);
  targets_.overrides->Asked(number, std::move(used));
  return nullptr;
}

}  // namespace flexarm
