#pragma once

#include "tools/bound/motion_trace.h"

namespace flexarm {

/// A motion that a search found, and how it went.
struct FoundMotion {
  MotionTrace trace;  ///< its last instant is the time; empty: nothing found within the limits
  double violation;   ///< FastestPlan::violation of the best
  int iterations;     ///< linear programs
};

}  // namespace flexarm
