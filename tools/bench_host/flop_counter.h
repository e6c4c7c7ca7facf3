#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace flexarm {

/// What one call of a function did.
struct WorkCount {
  std::int64_t flops;         ///< floating-point operations, by FlopsOf
  std::int64_t instructions;  ///< an instruction that repeats itself counts each time
};

/// A count, or why there is none.
struct CountResult {
  WorkCount count{};
  std::string problem;  ///< empty: counted
  bool counted() const noexcept { return problem.empty(); }
};

/// Counts what the second call of `work` does, instruction by instruction: the very code that is
/// timed, in whichever version this processor runs.
///
/// A child process calls `work` once freely, for what only a first call does, and once more one
/// instruction at a time (ptrace), some microseconds each. Nothing that the child changes in memory
/// is seen here. Needs no permission but that to trace a child, which some containers refuse.
/// No other thread of this process may hold a lock that `work` needs.
/// @param most_instructions  the count is given up beyond this
CountResult CountWork(const std::function<void()>& work, std::int64_t most_instructions);

}  // namespace flexarm
