#include "controller/operator/override_record.h"

#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "controller/tasks/loop_stack.h"  // of the safety machine: names of requests

namespace flexarm {

void OverrideRecord::Asked(std::uint32_t number, std::vector<Override> overrides) {
  if (!overrides.empty()) asked_[number] = std::move(overrides);
}

void OverrideRecord::Answered(std::int64_t now_ns, const RequestAnswer& answer) {
  const auto found = asked_.find(answer.number);
  if (found == asked_.end()) return;
  const std::vector<Override> overrides = std::move(found->second);
  asked_.erase(found);
  if (answer.refusal != Refusal::kNone) return;
  granted_ns_ = now_ns;
  for (const Override& granted : overrides) {
    in_force_.push_back(granted);
    events_->Push({.time_ns = now_ns,
                   .kind = "override",
                   .name = granted.condition,
                   .text = granted.reason,
                   .value_json = nlohmann::json{{"request", answer.number},
                                                {"command", ToString(answer.kind)},
                                                {"found", granted.found}}
                                     .dump()});
    report_(true, std::string(ToString(answer.kind)) + ": the condition '" + granted.condition +
                      "' is overridden: " + granted.reason + " (found: " + granted.found + ")");
  }
}

// A permit of before the grant may still say Idle.
void OverrideRecord::Follow(const Permit& permit) {
  if (permit.state == SafetyState::kIdle && permit.renewed_ns > granted_ns_) in_force_.clear();
}

nlohmann::json OverrideRecord::Json() const {
  nlohmann::json all = nlohmann::json::array();
  for (const Override& o : in_force_) {
    all.push_back({{"condition", o.condition}, {"reason", o.reason}, {"found", o.found}});
  }
  return all;
}

}  // namespace flexarm
