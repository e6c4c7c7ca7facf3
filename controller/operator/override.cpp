#include "controller/operator/override.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "controller/files/one_line.h"
#include "controller/types/rejected_error.h"

namespace flexarm {
ConditionDecision Judge(const std::vector<UnmetCondition>& unmet,
                        const std::vector<Override>& overrides) {
  ConditionDecision decision{.refused = nullptr, .used = {}};
  for (const UnmetCondition& condition : unmet) {
    const auto given = std::find_if(overrides.begin(), overrides.end(), [&](const Override& o) {
      return o.condition == condition.name;
    });
    if (given == overrides.end() || !condition.may_override) {
      return {.refused = &condition, .used = {}};
    }
    decision.used.push_back(*given);
    decision.used.back().found = condition.found;
  }
  return decision;
}

std::string ProblemOfReason(const std::string& reason) {
  return ProblemOfLine(reason, kLongestReason);
}

std::vector<Override> OverridesOf(const nlohmann::json& command,
                                  const std::vector<std::string>& conditions) {
  const auto given = command.find("overrides");
  if (given == command.end()) return {};
  if (!given->is_object()) throw RejectedError("overrides: must be an object of reasons");
  for (const auto& [name, reason] : given->items()) {
    if (std::find(conditions.begin(), conditions.end(), name) == conditions.end()) {
      throw RejectedError("overrides: this command has no such condition: '" + name + "'");
    }
    if (!reason.is_string()) throw RejectedError("overrides: the reason must be a text");
    if (const std::string problem = ProblemOfReason(reason.get<std::string>()); !problem.empty()) {
      throw RejectedError("overrides: the reason for '" + name + "' " + problem);
    }
  }
  std::vector<Override> overrides;
  for (const std::string& name : conditions) {
    if (given->contains(name)) {
      overrides.push_back({.condition = name, .reason = given->at(name).get<std::string>()});
    }
  }
  return overrides;
}

}  // namespace flexarm
