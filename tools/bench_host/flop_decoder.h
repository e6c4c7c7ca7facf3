#pragma once

#include <cstdint>
#include <span>

namespace flexarm {

/// Longest instruction of x86-64, bytes.
inline constexpr std::size_t kLongestInstruction = 15;

/// Floating-point operations that one instruction of x86-64 makes: sums, differences, products,
/// quotients and square roots, one for each lane of a vector; two for a fused product and sum.
///
/// Comparisons, minima, conversions, moves and approximations of a reciprocal count nothing. The
/// mask of an AVX-512 instruction is not looked at: all its lanes count.
/// Source: Intel 64 and IA-32 Architectures Software Developer's Manual, volume 2, appendix A.
/// @param instruction  begins with its first byte; may be longer than it
int FlopsOf(std::span<const std::uint8_t> instruction) noexcept;

}  // namespace flexarm
