#include "controller/operator/command_dispatch.h"

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "controller/files/external_text.h"
#include "controller/operator/command_text.h"
#include "controller/operator/log_condition.h"
#include "controller/operator/operator_roles.h"
#include "controller/operator/request_answers.h"
#include "controller/types/named_rejection.h"
#include "hal/line_names.h"

namespace flexarm {
namespace {

nlohmann::json BadRequest(const std::string& error) {
  return {{"ok", false}, {"refusal", "bad-request"}, {"error", error}};
}

nlohmann::json BadRequest(const std::string& error, const std::string& remedy) {
  nlohmann::json json = BadRequest(error);
  json["remedy"] = remedy;
  return json;
}

// Those that the safety task alone judges.
std::optional<RequestKind> RequestByName(const std::string& name) {
  for (const RequestKind kind : {RequestKind::kStop, RequestKind::kDisarm, RequestKind::kReset}) {
    if (name == ToString(kind)) return kind;
  }
  return std::nullopt;
}

// Commands after which the arm may move, at once or later.
bool AddsEnergy(const std::string& name) {
  return name == "arm" || name == "run" || name == "pluck" || name == "home" ||
         ChangeCommand::Knows(name);
}

}  // namespace

CommandDispatch::CommandDispatch(Targets targets) : targets_(std::move(targets)) {}

nlohmann::json CommandDispatch::Answer(int client, const Peer& by, const std::string& line,
                                       const OperatorSnapshot& now) {
  const std::optional<nlohmann::json> command = ParseCommand(line);
  const std::string name = command ? std::string((*command)["command"]) : std::string();
  targets_.record->Asked(client, by, name);
  nlohmann::json answer;
  try {
    answer = command ? Dispatch(client, by, *command, now)
                     : BadRequest("not a command: expected a line like {\"command\": \"status\"}",
                                  "use the flexarm program");
  } catch (const NamedRejection& error) {
    answer = {{"ok", false}, {"refusal", error.name()}, {"error", error.what()}};
  } catch (const RejectedError& error) {
    answer = BadRequest(error.what());
  } catch (const std::exception& error) {
    answer = {{"ok", false}, {"error", error.what()}};
  }
  if (answer.is_null()) return answer;
  if (command) answer["command"] = name;
  answer["state"] = ToString(now.permit.state);
  return answer;
}

nlohmann::json CommandDispatch::Dispatch(int client, const Peer& by, const nlohmann::json& command,
                                         const OperatorSnapshot& now) {
  const std::string name = command["command"];
  if (!Permits(by.role, name)) return NotPermittedJson(by, name);
  if (name == "status") return targets_.status();
  if (now.shutting_down && name != "stop" && name != "disarm") {
    return RefusalJson(RequestKind::kNone, Refusal::kShuttingDown, now.permit.state);
  }
  nlohmann::json held = targets_.lease->Judge(now.now_ns, by, command, now.permit.state);
  if (!held.is_null()) return held;
  if (const std::string job = JobUnderWay(); AddsEnergy(name) && !job.empty()) {
    return {{"ok", false},
            {"refusal", ToString(Refusal::kBusy)},
            {"error", job + " is under way"},
            {"remedy", "repeat the command after its end, or stop it"}};
  }
  return Start(name, client, command, now);
}

std::string CommandDispatch::JobUnderWay() const {
  if (targets_.arm->waits()) return "an arm";
  if (targets_.run->planning()) return "the planning of a run";
  if (targets_.change->planning()) return "a change of the path";
  if (targets_.requests->busy()) return "an arm, run or reset";
  return targets_.commissioning->busy() ? "a command of commissioning" : "";
}

nlohmann::json CommandDispatch::Start(const std::string& name, int client,
                                      const nlohmann::json& command, const OperatorSnapshot& now) {
  if (name == "sim") return SetLine(command);
  if (name == "limits") return SetLimits(command, now);
  if (name == "arm") return targets_.arm->Start(command, client, now);
  if (name == "run") return targets_.run->Start(command, client, now);
  if (ChangeCommand::Knows(name)) return targets_.change->Start(name, command, client, now);
  if (name == "prove-switches") {
    targets_.switches->Start(client, now.permit.state);
    return nullptr;
  }
  if (Commissioner::Knows(name)) {
    // In another state than Armed the commissioner says what is wrong.
    const bool moves =
        (name == "pluck" || name == "home") && now.permit.state == SafetyState::kArmed;
    if (const auto no_log = UnmetLog(targets_.files); moves && no_log) {
      return {{"ok", false},
              {"refusal", no_log->refusal},
              {"error", no_log->found},
              {"remedy", no_log->remedy}};
    }
    targets_.commissioning->Start(command, client, now);
    return nullptr;
  }
  if (const std::optional<RequestKind> kind = RequestByName(name)) {
    if (*kind != RequestKind::kReset) {
      targets_.arm->Cancel();
      targets_.run->Cancel();
      targets_.change->Cancel();
    }
    const RequestTracker::Asked asked = targets_.requests->Ask(*kind, now.now_ns, client);
    if (asked.number != 0) return nullptr;
    return RefusalJson(*kind, asked.refusal, now.permit.state);
  }
  return BadRequest("no such command: '" + Shown(name) + "'",
                    "one of status, arm, run, pause, resume, speed, retarget, stop, disarm, reset, "
                    "tare, zero, calibrate, pluck, home, prove-switches, limits, sim");
}

// The safety task takes other limits only while the relay is open, so they are those of the next
// arming: an arm that is under way has been judged by the old ones.
nlohmann::json CommandDispatch::SetLimits(const nlohmann::json& command,
                                          const OperatorSnapshot& now) {
  const std::string wanted = TextOf(command, "limits", "");
  if (wanted != "full" && wanted != "reduced") {
    return BadRequest("limits: \"full\" or \"reduced\" is expected");
  }
  if (RelayClosed(now.permit.state) || !JobUnderWay().empty()) {
    return {{"ok", false},
            {"refusal", ToString(Refusal::kWrongState)},
            {"error", "The limits change only while the arm is disarmed."},
            {"remedy", "`flexarm disarm`, then repeat the command"}};
  }
  const bool reduced = wanted == "reduced";
  targets_.stack->SetReduced(reduced);
  targets_.report(false, reduced ? "limits: reduced" : "limits: full, as in the config");
  return {{"ok", true}, {"limits", wanted}};
}

nlohmann::json CommandDispatch::SetLine(const nlohmann::json& command) {
  const std::optional<Line> line = LineByName(TextOf(command, "line", ""));
  const auto given = command.find("level");
  const bool whole = given != command.end() && given->is_number_integer();
  const std::int64_t level = whole ? given->get<std::int64_t>() : -1;
  if (!line || (level != 0 && level != 1)) {
    return BadRequest("no such line or level",
                      "limit-1-low, limit-1-high, limit-2-low, limit-2-high, emergency-stop or "
                      "reset-button, and level 0 or 1");
  }
  if (!targets_.stack->Press({.line = *line, .level = static_cast<int>(level)})) {
    return {{"ok", false},
            {"refusal", "not-simulated"},
            {"error", "this backend has no simulated switches"},
            {"remedy", "press the real one"}};
  }
  targets_.report(
      false, std::string("simulated line ") + ToString(*line) + " set to " + std::to_string(level));
  return {{"ok", true}, {"line", ToString(*line)}, {"level", level}};
}

}  // namespace flexarm
