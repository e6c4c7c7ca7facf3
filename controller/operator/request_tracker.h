#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "controller/latch/trip_latch.h"
#include "controller/tasks/loop_stack.h"

namespace flexarm {

/// Numbers the requests to the safety task, and records which clients wait for each answer.
///
/// One arm, run, change or reset at a time: while it is not answered, another is not made. An arm
/// is made only once the latch file says armed, on disk. Stop and disarm are always made, and wait
/// behind nothing; several that are not answered yet share one answer. Each request is answered
/// once. Not real-time safe: allocates, and an arm waits for the disk. Thread: operator.
class RequestTracker {
 public:
  /// Requests of an unattended run have the numbers 1, 2, ..: these come after them.
  static constexpr std::uint32_t kFirstNumber = 1'001;
  static constexpr int kNoClient = -1;

  /// A request that was made, or why it was not.
  struct Asked {
    std::uint32_t number = 0;          ///< 0: it was not made
    Refusal refusal = Refusal::kNone;  ///< then kBusy or kNotKept
    std::string why{};                 ///< of kNotKept: the file and the system's error
  };

  /// Both outlive the tracker.
  RequestTracker(LoopStack* stack, TripLatch* latch) : stack_(stack), latch_(latch) {}

  /// True while an arm, run, change or reset is not answered yet.
  bool busy() const { return judged_ != 0; }

  /// Makes a request; `client` waits for its answer.
  Asked Ask(RequestKind kind, std::int64_t now_ns, int client = kNoClient,
            const RunOrder& run = {});

  /// Asks for a change of the path of run `changes`, which may be granted until `not_after_ns`.
  Asked AskForChange(std::int64_t now_ns, int client, const RunOrder& run, std::uint32_t changes,
                     std::int64_t not_after_ns);

  /// Makes a request of an unattended run, with its own number.
  Asked AskPlanned(const OperatorRequest& request);

  /// Every answer of the safety task, in order.
  /// @returns the clients that wait for it, each once
  std::vector<int> TakeClientsOf(const RequestAnswer& answer);

 private:
  struct Waiting {
    std::uint32_t number;
    RequestKind kind;
    int client;
  };

  /// Empty if the arm may be asked for.
  Asked Prepare(RequestKind kind);

  LoopStack* stack_;
  TripLatch* latch_;
  std::uint32_t next_number_ = kFirstNumber;
  std::uint32_t judged_ = 0;      // the arm, run or reset that is not answered yet
  std::vector<Waiting> waiting_;  // in order of number
};

}  // namespace flexarm
