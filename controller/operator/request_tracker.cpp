#include "controller/operator/request_tracker.h"

#include <algorithm>

namespace flexarm {
namespace {

// Requests that are latched, not queued.
bool Latched(RequestKind kind) {
  return kind == RequestKind::kStop || kind == RequestKind::kDisarm;
}

}  // namespace

std::uint32_t RequestTracker::Ask(RequestKind kind, std::int64_t now_ns, int client,
                                  const RunOrder& run) {
  if (!Latched(kind) && busy()) return 0;
  const std::uint32_t number = next_number_++;
  if (client != kNoClient) {
    waiting_.push_back({.number = number, .kind = kind, .client = client});
  }
  if (kind == RequestKind::kStop) {
    stack_->stop().Set(number);
  } else if (kind == RequestKind::kDisarm) {
    stack_->disarm().Set(number);
  } else {
    judged_ = number;
    stack_->requests().Push({.kind = kind, .number = number, .not_before_ns = now_ns, .run = run});
  }
  return number;
}

void RequestTracker::AskPlanned(const OperatorRequest& request) {
  if (!Latched(request.kind)) judged_ = request.number;
  stack_->requests().Push(request);
}

std::vector<int> RequestTracker::TakeClientsOf(const RequestAnswer& answer) {
  if (answer.number == judged_) judged_ = 0;
  // The answer to a latched request answers those of its kind that it has replaced.
  const auto answered = [&](const Waiting& waits) {
    return waits.number == answer.number ||
           (Latched(answer.kind) && waits.kind == answer.kind && waits.number < answer.number);
  };
  std::vector<int> clients;
  for (const Waiting& waits : waiting_) {
    if (answered(waits)) clients.push_back(waits.client);
  }
  std::erase_if(waiting_, answered);
  return clients;
}

}  // namespace flexarm
