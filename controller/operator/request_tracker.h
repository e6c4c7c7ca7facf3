#pragma once

#include <cstdint>
#include <vector>

#include "controller/tasks/loop_stack.h"

namespace flexarm {

/// Numbers the requests to the safety task, and records which clients wait for each answer.
///
/// One arm, run or reset at a time: while it is not answered, another is not made. Stop and disarm
/// are always made, and wait behind nothing; several that are not answered yet share one answer.
/// Each request is answered once. Not real-time safe: allocates. Thread: operator.
class RequestTracker {
 public:
  /// Requests of an unattended run have the numbers 1, 2, ..: these come after them.
  static constexpr std::uint32_t kFirstNumber = 1'001;
  static constexpr int kNoClient = -1;

  /// @param stack  outlives the tracker
  explicit RequestTracker(LoopStack* stack) : stack_(stack) {}

  /// True while an arm, run or reset is not answered yet.
  bool busy() const { return judged_ != 0; }

  /// Makes a request; `client` waits for its answer.
  /// @returns its number; 0: it was not made, because the tracker is busy
  std::uint32_t Ask(RequestKind kind, std::int64_t now_ns, int client = kNoClient,
                    const RunOrder& run = {});

  /// Makes a request of an unattended run.
  void AskPlanned(const OperatorRequest& request);

  /// Every answer of the safety task, in order.
  /// @returns the clients that wait for it, each once
  std::vector<int> TakeClientsOf(const RequestAnswer& answer);

 private:
  struct Waiting {
    std::uint32_t number;
    RequestKind kind;
    int client;
  };

  LoopStack* stack_;
  std::uint32_t next_number_ = kFirstNumber;
  std::uint32_t judged_ = 0;      // the arm, run or reset that is not answered yet
  std::vector<Waiting> waiting_;  // in order of number
};

}  // namespace flexarm
