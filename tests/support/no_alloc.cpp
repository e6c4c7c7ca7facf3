#include "tests/support/no_alloc.h"

#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>

namespace flexarm {
namespace {

// constinit: reading it must not run an initialiser.
constinit thread_local int armed = 0;

// Prints without allocating, and without a backtrace, which would allocate.
[[noreturn]] void Refuse(const char* function, std::size_t size) {
  armed = 0;
  char text[160] = "no_alloc: ";
  std::strncat(text, function, 40);
  char digits[24];
  char* first = digits + sizeof digits - 1;
  *first = '\0';
  do {
    *--first = static_cast<char>('0' + size % 10);
    size /= 10;
  } while (size != 0);
  std::strncat(text, " of ", 5);
  std::strncat(text, first, sizeof digits);
  std::strncat(text, " bytes on a thread that must not touch the heap\n", 60);
  // A failing write is ignored: the process ends in both cases.
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, text, std::strlen(text));
  std::abort();
}

[[maybe_unused]] void CheckHeapUse(const char* function, std::size_t size) {
  if (armed != 0) [[unlikely]] {
    Refuse(function, size);
  }
}

}  // namespace

NoAlloc::NoAlloc() noexcept { ++armed; }
NoAlloc::~NoAlloc() { --armed; }

}  // namespace flexarm

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

// glibc's allocator under the names that it exports for replacements; and the replacements.
// NOLINTBEGIN(bugprone-reserved-identifier, readability-inconsistent-declaration-parameter-name):
// the names are glibc's.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* block);

void* malloc(std::size_t size) {
  flexarm::CheckHeapUse("malloc", size);
  return __libc_malloc(size);
}

void* calloc(std::size_t count, std::size_t size) {
  flexarm::CheckHeapUse("calloc", count * size);
  return __libc_calloc(count, size);
}

void* realloc(void* block, std::size_t size) {
  flexarm::CheckHeapUse("realloc", size);
  return __libc_realloc(block, size);
}

void* memalign(std::size_t alignment, std::size_t size) {
  flexarm::CheckHeapUse("memalign", size);
  return __libc_memalign(alignment, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) {
  flexarm::CheckHeapUse("aligned_alloc", size);
  return __libc_memalign(alignment, size);
}

int posix_memalign(void** block, std::size_t alignment, std::size_t size) {
  flexarm::CheckHeapUse("posix_memalign", size);
  *block = __libc_memalign(alignment, size);
  return *block == nullptr ? ENOMEM : 0;
}

void free(void* block) {
  if (block != nullptr) flexarm::CheckHeapUse("free", 0);  // free(nullptr) does nothing
  __libc_free(block);
}
}  // extern "C"
// NOLINTEND(bugprone-reserved-identifier, readability-inconsistent-declaration-parameter-name)

#endif
