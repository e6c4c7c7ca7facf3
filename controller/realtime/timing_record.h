#pragma once

#include <cstdint>

namespace flexarm {

/// Wall-clock times of one activation of a task.
struct TimingRecord {
  std::int64_t tick;  ///< tick of the control task; activation number of other tasks
  std::int64_t due_ns;
  std::int64_t woke_ns;  ///< in the clock of the loop
  std::int64_t finished_ns;
};

}  // namespace flexarm
