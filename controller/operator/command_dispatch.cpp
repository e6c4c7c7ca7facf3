#include "controller/operator/command_dispatch.h"

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "controller/operator/command_text.h"
#include "controller/operator/request_answers.h"
#include "hal/line_names.h"

namespace flexarm {
namespace {

nlohmann::json Failure(const std::string& error, const std::string& remedy) {
  return {{"ok", false}, {"error", error}, {"remedy", remedy}};
}

// A refusal that the operator task gives without the safety task.
nlohmann::json Refused(RequestKind kind, Refusal refusal, SafetyState state) {
  nlohmann::json json = RefusalJson(kind, refusal, state);
  json["command"] = ToString(kind);
  json["state"] = ToString(state);
  return json;
}

// Those that the safety task alone judges.
std::optional<RequestKind> RequestByName(const std::string& name) {
  for (const RequestKind kind : {RequestKind::kStop, RequestKind::kDisarm, RequestKind::kReset}) {
    if (name == ToString(kind)) return kind;
  }
  return std::nullopt;
}

}  // namespace

CommandDispatch::CommandDispatch(Targets targets) : targets_(std::move(targets)) {}

nlohmann::json CommandDispatch::Answer(int client, const std::string& line,
                                       const OperatorSnapshot& now) {
  try {
    return Dispatch(client, line, now);
  } catch (const std::exception& error) {
    return {{"ok", false}, {"error", error.what()}};
  }
}

nlohmann::json CommandDispatch::Dispatch(int client, const std::string& line,
                                         const OperatorSnapshot& now) {
  const std::optional<nlohmann::json> parsed = ParseCommand(line);
  if (!parsed) {
    return Failure("not a command: expected a line like {\"command\": \"status\"}",
                   "use the flexarm program");
  }
  const nlohmann::json& command = *parsed;
  const std::string name = command["command"];
  if (name == "status") return targets_.status();
  if (now.shutting_down && name != "stop" && name != "disarm") {
    return {{"ok", false},
            {"refusal", ToString(Refusal::kShuttingDown)},
            {"error", RefusalText(RequestKind::kNone, Refusal::kShuttingDown, now.permit.state)},
            {"command", name},
            {"state", ToString(now.permit.state)}};
  }
  if (name == "sim") return SetLine(command, now.permit.state);
  if (name == "arm") return targets_.arm->Start(command, client, now);
  if (name == "run") return StartRun(command, client, now);
  if (name == "prove-switches") {
    targets_.switches->Start(client, now.permit.state);
    return nullptr;
  }
  if (Commissioner::Knows(name)) {
    targets_.commissioning->Start(command, client, now);
    return nullptr;
  }
  if (const std::optional<RequestKind> kind = RequestByName(name)) {
    if (*kind != RequestKind::kReset) targets_.arm->Cancel();
    const RequestTracker::Asked asked = targets_.requests->Ask(*kind, now.now_ns, client);
    if (asked.number != 0) return nullptr;
    return Refused(*kind, asked.refusal, now.permit.state);
  }
  return Failure("no such command: '" + name + "'",
                 "one of status, arm, run, stop, disarm, reset, tare, zero, calibrate, pluck, "
                 "home, prove-switches, sim");
}

nlohmann::json CommandDispatch::SetLine(const nlohmann::json& command, SafetyState state) {
  const std::optional<Line> line = LineByName(TextOf(command, "line", ""));
  const auto given = command.find("level");
  const bool whole = given != command.end() && given->is_number_integer();
  const std::int64_t level = whole ? given->get<std::int64_t>() : -1;
  if (!line || (level != 0 && level != 1)) {
    return Failure("no such line or level",
                   "limit-1-low, limit-1-high, limit-2-low, limit-2-high, emergency-stop or "
                   "reset-button, and level 0 or 1");
  }
  if (!targets_.stack->Press({.line = *line, .level = static_cast<int>(level)})) {
    return Failure("this backend has no simulated switches", "press the real one");
  }
  targets_.report(
      false, std::string("simulated line ") + ToString(*line) + " set to " + std::to_string(level));
  return {{"ok", true},
          {"command", "sim"},
          {"state", ToString(state)},
          {"line", ToString(*line)},
          {"level", level}};
}

nlohmann::json CommandDispatch::StartRun(const nlohmann::json& command, int client,
                                         const OperatorSnapshot& now) {
  const SafetyState state = now.permit.state;
  if (targets_.requests->busy()) return Refused(RequestKind::kRun, Refusal::kBusy, state);
  if (state != SafetyState::kArmed) {
    return Refused(RequestKind::kRun, Refusal::kWrongState, state);
  }
  if (const std::string why = targets_.commissioning->WhyNoRun(); !why.empty()) {
    return Failure(why, "then run");
  }
  const std::vector<UnmetCondition> unmet = targets_.switches->UnmetToRun();
  const ConditionDecision decision = Judge(unmet, OverridesOf(command, {kSwitchesCondition}));
  if (decision.refused != nullptr) {
    return {{"ok", false},
            {"refusal", decision.refused->refusal},
            {"error", decision.refused->found},
            {"remedy", decision.refused->remedy},
            {"command", "run"},
            {"state", ToString(state)}};
  }
  const std::string name = TextOf(command, "name", "experiment");
  const std::array<double, kCounters>& angle_rad = now.tick.output.angle_rad;
  const std::uint32_t number = targets_.experiments->AskForRun(
      now.now_ns, client,
      targets_.experiments->Plan(targets_.parse_experiment(TextOf(command, "experiment", ""), name),
                                 {angle_rad[0], angle_rad[1]}));
  targets_.overrides->Asked(number, decision.used);
  return nullptr;
}

}  // namespace flexarm
