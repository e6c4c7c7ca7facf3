#pragma once

#include <string>
#include <vector>

#include "model/problem.h"

namespace flexarm {

/// Section [loop]: timing of the control grid.
struct LoopConfig {
  double period_ms;          ///< Ts; sampling instants are at k Ts
  double acquire_before_ms;  ///< the control task runs this long after the sampling instant's grid
  double
      step_deadline_ms;  ///< a Step published later than this after its release missed its deadline

  std::vector<Problem> Problems() const;
};

/// Sections [daemon] and [log].
struct DaemonConfig {
  std::string socket;         ///< path of the operator's Unix socket; $VAR is not expanded
  std::string log_directory;  ///< key log.directory: where run logs go

  std::vector<Problem> Problems() const;
};

}  // namespace flexarm
