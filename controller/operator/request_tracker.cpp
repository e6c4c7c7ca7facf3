#include "controller/operator/request_tracker.h"

#include <algorithm>
#include <utility>

namespace flexarm {
namespace {

// Requests that are latched, not queued.
bool Latched(RequestKind kind) {
  return kind == RequestKind::kStop || kind == RequestKind::kDisarm;
}

}  // namespace

RequestTracker::Asked RequestTracker::Prepare(RequestKind kind) {
  if (kind != RequestKind::kArm) return {};
  std::string why = latch_->PrepareArm(stack_->operator_permits().Read().Newest().value);
  if (why.empty()) return {};
  return {.number = 0, .refusal = Refusal::kNotKept, .why = std::move(why)};
}

RequestTracker::Asked RequestTracker::Ask(RequestKind kind, std::int64_t now_ns, int client,
                                          const RunOrder& run) {
  if (!Latched(kind) && busy()) return {.number = 0, .refusal = Refusal::kBusy};
  if (Asked refused = Prepare(kind); refused.refusal != Refusal::kNone) return refused;
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
  return {.number = number};
}

RequestTracker::Asked RequestTracker::AskForChange(std::int64_t now_ns, int client,
                                                   const RunOrder& run, std::uint32_t changes,
                                                   std::int64_t not_after_ns) {
  if (busy()) return {.number = 0, .refusal = Refusal::kBusy};
  judged_ = next_number_++;
  if (client != kNoClient) {
    waiting_.push_back({.number = judged_, .kind = RequestKind::kChange, .client = client});
  }
  stack_->requests().Push({.kind = RequestKind::kChange,
                           .number = judged_,
                           .not_before_ns = now_ns,
                           .run = run,
                           .changes = changes,
                           .not_after_ns = not_after_ns});
  return {.number = judged_};
}

RequestTracker::Asked RequestTracker::AskPlanned(const OperatorRequest& request) {
  if (Asked refused = Prepare(request.kind); refused.refusal != Refusal::kNone) return refused;
  if (!Latched(request.kind)) judged_ = request.number;
  stack_->requests().Push(request);
  return {.number = request.number};
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
