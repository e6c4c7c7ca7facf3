#pragma once

namespace flexarm {

/// True where the allocator can be replaced: the sanitizers bring their own.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kNoAllocWorks = false;
#else
inline constexpr bool kNoAllocWorks = true;
#endif

/// While one of these lives, this thread must not touch the heap: malloc, calloc, realloc, free of
/// a block, aligned allocation, and so operator new and delete. The first that does says so on
/// stderr and aborts the process.
class NoAlloc {
 public:
  NoAlloc() noexcept;
  ~NoAlloc();
  NoAlloc(const NoAlloc&) = delete;
  NoAlloc& operator=(const NoAlloc&) = delete;
};

}  // namespace flexarm
