#pragma once

#include <cstdint>

namespace flexarm {

/// Wall-clock figures of one activation of a task.
struct TimingRecord {
  std::int64_t tick;  ///< of the control task; activation number otherwise
  std::int64_t due_ns;
  std::int64_t woke_ns;  ///< in the clock of the loop
  std::int64_t finished_ns;
};

}  // namespace flexarm
