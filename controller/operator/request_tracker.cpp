#include "controller/operator/request_tracker.h"

namespace flexarm {

std::uint32_t RequestTracker::Ask(RequestKind kind, std::int64_t now_ns, LineLevels may_open) {
  const std::uint32_t number = next_number_++;
  requests_->Push({.kind = kind, .number = number, .not_before_ns = now_ns, .may_open = may_open});
  return number;
}

void RequestTracker::AskFor(int client, RequestKind kind, std::int64_t now_ns) {
  waiting_.push_back({.number = Ask(kind, now_ns), .client = client});
}

std::optional<int> RequestTracker::TakeClientOf(const RequestAnswer& answer) {
  if (waiting_.empty() || waiting_.front().number != answer.number) return std::nullopt;
  const int client = waiting_.front().client;
  waiting_.pop_front();
  return client;
}

}  // namespace flexarm
