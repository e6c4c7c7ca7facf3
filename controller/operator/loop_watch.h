#pragma once

#include <cstdint>

#include "controller/operator/journal_report.h"
#include "controller/operator/operator_snapshot.h"

namespace flexarm {

/// Whether safety and control are alive: the service manager's watchdog is notified only then. The
/// journal says when that ends, and why, and when it begins again.
/// Not real-time safe. Thread: operator.
class LoopWatch {
 public:
  static constexpr std::int64_t kOldestNs = 100'000'000;  ///< an older permit or step: not alive

  /// Once a period. @returns whether the loop is alive
  bool Follow(const OperatorSnapshot& now, const JournalReport& report);

 private:
  bool began_ = false;  // it has been alive once
  bool alive_ = false;
};

}  // namespace flexarm
