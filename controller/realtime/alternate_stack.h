#pragma once

#include <csignal>
#include <cstddef>
#include <vector>

namespace flexarm {

/// A stack of the calling thread for signal handlers with SA_ONSTACK: one that runs because the
/// thread's own stack has overflowed needs another. Construct and destroy it in that thread, which
/// allocates and frees: not in a loop. Threads: each its own.
class AlternateStack {
 public:
  /// Does nothing where the thread already has one: a sanitizer gives each thread its own.
  AlternateStack();
  ~AlternateStack();
  AlternateStack(const AlternateStack&) = delete;
  AlternateStack& operator=(const AlternateStack&) = delete;

 private:
  std::vector<std::byte> bytes_;
};

}  // namespace flexarm
