#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "controller/operator/journal_report.h"
#include "controller/operator/override.h"
#include "controller/runlog/event_queue.h"
#include "controller/types/messages.h"

namespace flexarm {

/// The overrides in force: those of the requests that were granted, from the grant until the arm is
/// disarmed. Each becomes an event "override" of the log and a line of the journal when its request
/// is granted. Not real-time safe. Thread: operator.
class OverrideRecord {
 public:
  /// @param events  to the recorder; outlives this
  OverrideRecord(EventQueue* events, JournalReport report)
      : events_(events), report_(std::move(report)) {}

  /// The request `number` was made with these overrides.
  void Asked(std::uint32_t number, std::vector<Override> overrides);

  /// Every answer of the safety task, in order.
  void Answered(std::int64_t now_ns, const RequestAnswer& answer);

  /// Once a period: forgets the overrides of an arm that was disarmed.
  void Follow(const Permit& permit);

  const std::vector<Override>& in_force() const { return in_force_; }

  /// For the status: [{"condition", "reason", "found"}].
  nlohmann::json Json() const;

 private:
  EventQueue* events_;
  JournalReport report_;
  std::map<std::uint32_t, std::vector<Override>> asked_;  // by number of the request
  std::vector<Override> in_force_;
  std::int64_t granted_ns_ = INT64_MIN;
};

}  // namespace flexarm
