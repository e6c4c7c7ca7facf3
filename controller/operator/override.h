#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace flexarm {

// A request can have conditions beyond those of the safety machine, such as a machine that is good
// enough. Some of them a person may override for one request, with a reason that is recorded.
//
// In a command: {"command": "arm", "overrides": {"host": "REASON"}}. The names are those of the
// conditions. Pure functions. Not real-time safe.

/// A person's decision to do without one condition.
struct Override {
  std::string condition;   ///< "host"
  std::string reason;      ///< in the person's words
  std::string found = {};  ///< what did not hold, once the request is judged

  friend bool operator==(const Override&, const Override&) = default;
};

/// A condition of a request that does not hold.
struct UnmetCondition {
  std::string name;     ///< "host"
  std::string refusal;  ///< machine name, as in JSON: "host-not-ready"
  std::string found;    ///< what does not hold
  std::string remedy;   ///< what to do
  bool may_override;    ///< by an Override of its name
};

/// What follows from the conditions that do not hold, and from the overrides of the request.
struct ConditionDecision {
  const UnmetCondition* refused;  ///< the first that forbids the request; nullptr: none does
  std::vector<Override> used;     ///< overrides without which it would be refused
};

/// Judges a request. An override of what holds is not used.
/// @param unmet  outlives the decision
ConditionDecision Judge(const std::vector<UnmetCondition>& unmet,
                        const std::vector<Override>& overrides);

inline constexpr std::size_t kLongestReason = 200;  ///< bytes

/// Why a text cannot be the reason of an override; "" if it can. A reason is one line of UTF-8 with
/// a visible character, without control characters or those that reverse the direction of text: it
/// is shown in the journal and on terminals as it is.
std::string ProblemOfReason(const std::string& reason);

/// The overrides of a command, in the order of `conditions`.
/// @param conditions  names that this command knows
/// @throws RejectedError for another name, or a reason that ProblemOfReason refuses
std::vector<Override> OverridesOf(const nlohmann::json& command,
                                  const std::vector<std::string>& conditions);

}  // namespace flexarm
