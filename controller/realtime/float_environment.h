#pragma once

#include <cstdint>

#if defined(__SSE2__)
#include <xmmintrin.h>
#elif !defined(__aarch64__)
#error "no way to flush denormals is implemented for this processor"
#endif

namespace flexarm {

/// RAII guard: flushes denormal numbers to zero (results and operands) on this thread during its
/// lifetime, then restores the previous mode.
///
/// Both executors run tasks in this mode: arithmetic with denormals is about a hundred times
/// slower, and both must compute the same bits.
class FlushDenormals {
 public:
  FlushDenormals() noexcept : before_(Read()) { Write(before_ | kFlush); }
  ~FlushDenormals() { Write(before_); }
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

 private:
#if defined(__SSE2__)
  using Word = std::uint32_t;
  static constexpr Word kFlush = 0x8040;  // MXCSR: FTZ, DAZ
  static Word Read() noexcept { return _mm_getcsr(); }
  static void Write(Word word) noexcept { _mm_setcsr(word); }
#else
  using Word = std::uint64_t;
  static constexpr Word kFlush = Word{1} << 24;  // FPCR: FZ
  static Word Read() noexcept {
    Word word;
    asm volatile("mrs %0, fpcr" : "=r"(word));
    return word;
  }
  static void Write(Word word) noexcept { asm volatile("msr fpcr, %0" : : "r"(word)); }
#endif

  Word before_;
};

}  // namespace flexarm
