#pragma once

#include "controller/realtime/realtime_setup.h"
#include "tests/support/sanitizer.h"

namespace flexarm {

/// True where a test may run threads with SCHED_FIFO.
///
/// Never with the thread sanitizer. Its runtime has spin locks: threads that wait for one with
/// sched_yield keep their processors, so a holder of lower priority never runs again.
inline bool FifoPermitted(int priority) {
  return !kThreadSanitizer && ReadRealtimeHost(priority).fifo_error == 0;
}

}  // namespace flexarm
