#include "tools/bench_host/float_bound.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "tools/bench_host/timing.h"

namespace flexarm {
namespace {

// Chains that do not wait for each other. A processor begins two operations a cycle and ends each
// four cycles later, so that eight would do.
constexpr std::size_t kChains = 12;
constexpr int kRounds = 1000;

// Sums of products x a + b, which stay near 1. Compiled with -ffp-contract=fast, so that a target
// that can fuses product and sum. Returns what it computed, for the compiler must not leave it out.
#define FLEXARM_CHAINS(name, attribute, bytes)                       \
  attribute double name() {                                          \
    using Vector = double __attribute__((vector_size(bytes)));       \
    const Vector factor = Vector{} + 0.999, term = Vector{} + 0.001; \
    std::array<Vector, kChains> x;                                   \
    for (std::size_t i = 0; i < kChains; ++i) {                      \
      x[i] = Vector{} + 0.1 * static_cast<double>(i);                \
    }                                                                \
    for (int round = 0; round < kRounds; ++round) {                  \
      for (Vector & chain : x) chain = chain * factor + term;        \
    }                                                                \
    double sum = 0.0;                                                \
    for (const Vector& chain : x) sum += chain[0];                   \
    return sum;                                                      \
  }

FLEXARM_CHAINS(Chains16, , 16)
#ifdef __x86_64__
FLEXARM_CHAINS(Chains32, [[gnu::target("avx2,fma")]], 32)
FLEXARM_CHAINS(Chains64, [[gnu::target("avx512f")]], 64)
#endif
#undef FLEXARM_CHAINS

volatile double computed = 0.0;

FloatBound Measure(const char* name, const char* what, double (*chains)(), std::size_t bytes,
                   const Repetitions& repetitions) {
  const std::size_t lanes = bytes / sizeof(double);
  const double flops = 2.0 * kRounds * static_cast<double>(kChains * lanes);
  const Timing timing = TimeWork([chains] { computed = chains(); }, repetitions);
  return {.name = name, .what = what, .flops_per_s = flops / timing.least_s};
}

}  // namespace

std::vector<FloatBound> MeasureFloatBounds(const Repetitions& repetitions) {
  std::vector<FloatBound> bounds;
#ifdef __x86_64__
  bounds.push_back(Measure("sse2", "2 doubles a register (SSE2)", Chains16, 16, repetitions));
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
    bounds.push_back(
        Measure("avx2", "4 doubles a register, fused (AVX2, FMA)", Chains32, 32, repetitions));
  }
  if (__builtin_cpu_supports("avx512f")) {
    bounds.push_back(
        Measure("avx512", "8 doubles a register, fused (AVX-512)", Chains64, 64, repetitions));
  }
#else
  bounds.push_back(Measure("two", "2 doubles a register", Chains16, 16, repetitions));
#endif
  return bounds;
}

double BestOf(const std::vector<FloatBound>& bounds) {
  double best = 0.0;
  for (const FloatBound& bound : bounds) best = std::max(best, bound.flops_per_s);
  return best;
}

}  // namespace flexarm
