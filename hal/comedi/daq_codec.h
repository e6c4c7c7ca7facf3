#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace flexarm {

/// Values of a converter with `bits` bits, 0 .. 2^bits - 1, and a range of -range_v .. +range_v: 0
/// V is 2^(bits-1), a step is 2 range / 2^bits, as in StrainInputConfig. Real-time: safe.
constexpr std::uint32_t ZeroCode(int bits) noexcept { return std::uint32_t{1} << (bits - 1); }

/// Whether a converter with `bits` bits has this code: a driver may return any number.
constexpr bool IsCode(std::uint32_t code, int bits) noexcept { return code >> bits == 0; }

/// Converter code as a signed count. @param code  IsCode
constexpr std::int32_t CountsFromCode(std::uint32_t code, int bits) noexcept {
  return static_cast<std::int32_t>(code) - static_cast<std::int32_t>(ZeroCode(bits));
}

/// The code nearest to `volts`, clipped to the range; NaN is 0 V.
inline std::uint32_t CodeFromVolts(double volts, double range_v, int bits) noexcept {
  const double zero = ZeroCode(bits);
  if (!std::isfinite(volts)) return ZeroCode(bits);
  const double code = zero + std::nearbyint(volts / range_v * zero);
  return static_cast<std::uint32_t>(std::clamp(code, 0.0, 2.0 * zero - 1.0));
}

}  // namespace flexarm
