#pragma once

#include "tests/support/sanitizer.h"

namespace flexarm {

/// True where the allocator can be replaced: the sanitizers have their own.
inline constexpr bool kNoAllocWorks = !kSanitized;

/// While one of these exists, this thread must not use the heap: malloc, calloc, realloc, free of
/// a block, aligned allocation, and so operator new and delete. The first call is reported on
/// stderr and aborts the process.
class NoAlloc {
 public:
  NoAlloc() noexcept;
  ~NoAlloc();
  NoAlloc(const NoAlloc&) = delete;
  NoAlloc& operator=(const NoAlloc&) = delete;
};

}  // namespace flexarm
