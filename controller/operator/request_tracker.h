#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "controller/tasks/loop_stack.h"

namespace flexarm {

/// Numbers the requests to the safety task, and records which client each answer is for.
///
/// The safety task answers the requests of clients in the order in which they were made.
/// Not real-time safe: allocates. Thread: operator.
class RequestTracker {
 public:
  /// Requests of an unattended run have the numbers 1, 2, ..: these come after them.
  static constexpr std::uint32_t kFirstNumber = 1'001;

  /// @param requests  to the safety task; outlives the tracker
  explicit RequestTracker(SpscQueue<OperatorRequest>* requests) : requests_(requests) {}

  /// Makes a request that no client waits for.
  /// @param may_open  of a homing run: the limit switch that it looks for
  /// @returns its number
  std::uint32_t Ask(RequestKind kind, std::int64_t now_ns, LineLevels may_open = 0);

  /// Makes a request whose answer `client` waits for.
  void AskFor(int client, RequestKind kind, std::int64_t now_ns);

  /// Every answer of the safety task, in order.
  /// @returns the client that waits for it, once; empty: none does
  std::optional<int> TakeClientOf(const RequestAnswer& answer);

 private:
  struct Waiting {
    std::uint32_t number;
    int client;
  };

  SpscQueue<OperatorRequest>* requests_;
  std::uint32_t next_number_ = kFirstNumber;
  std::deque<Waiting> waiting_;  // in order of number
};

}  // namespace flexarm
