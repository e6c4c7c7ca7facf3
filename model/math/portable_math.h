#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "model/math/lanes.h"

namespace flexarm {

/// Sine and cosine of one angle, or of four.
template <typename Scalar>
struct SineCosineOf {
  Scalar sine, cosine;  ///< 1
};
using SineCosine = SineCosineOf<double>;

/// Elementary functions from + - * / alone: bit-identical on every machine that follows IEEE 754.
///
/// libm's sin and exp differ between processors and versions, and so would a replay. Taylor
/// polynomials on a reduced argument, long enough that truncation stays far below round-off.
/// Built without contraction (-ffp-contract=off). NaN in, NaN out.
/// Real-time: safe. Usable in constant expressions.
struct PortableMath {
  /// Largest |angle| of SinCos: 159 turns.
  static constexpr double kMaxAngle_rad = 1000.0;

  /// Within 1.2 ulp of the true values, near their zeros too; NaN beyond kMaxAngle_rad.
  static constexpr SineCosine SinCos(double angle_rad) noexcept {
    if (!(angle_rad >= -kMaxAngle_rad && angle_rad <= kMaxAngle_rad)) {
      return {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
    }
    const int n = Nearest(angle_rad * kPerQuarter);
    return OfQuarter(n, NearQuarter(angle_rad, static_cast<double>(n)));
  }

  /// The same of each lane, to the bit.
  static SineCosineOf<Lanes> SinCos(const Lanes& angle_rad) noexcept {
    std::array<int, Lanes::kCount> n{};
    Lanes quarters;
    for (std::size_t lane = 0; lane < Lanes::kCount; ++lane) {
      const double angle = angle_rad[lane];
      const bool known = angle >= -kMaxAngle_rad && angle <= kMaxAngle_rad;
      if (known) n[lane] = Nearest(angle * kPerQuarter);
      quarters.Set(lane, known ? n[lane] : std::numeric_limits<double>::quiet_NaN());
    }
    const SineCosineOf<Lanes> near = NearQuarter(angle_rad, quarters);
    SineCosineOf<Lanes> out;
    for (std::size_t lane = 0; lane < Lanes::kCount; ++lane) {
      const SineCosine one = OfQuarter(n[lane], {near.sine[lane], near.cosine[lane]});
      out.sine.Set(lane, one.sine);
      out.cosine.Set(lane, one.cosine);
    }
    return out;
  }

  /// Within 2.5 ulp, relative accuracy near zero included; +-1 for large |x|.
  static constexpr double Tanh(double x) noexcept {
    const double size = x < 0.0 ? -x : x;
    if (size > 20.0) return x < 0.0 ? -1.0 : 1.0;  // 1 - tanh(20) is 0.08 ulp
    const double growth = ExpMinus1(2.0 * size);
    const double value = growth / (growth + 2.0);
    return x < 0.0 ? -value : value;
  }

 private:
  static constexpr double kPerQuarter = 0x1.45f306dc9c883p-1;  // 2/pi

  // Of the angle less so many quarters of a turn.
  template <typename Scalar>
  static constexpr SineCosineOf<Scalar> NearQuarter(const Scalar& angle_rad,
                                                    const Scalar& quarters) noexcept {
    // pi/2 in three parts: the first two have 33 bits, so that their products with n are exact.
    constexpr double kPart1 = 0x1.921fb544p+0, kPart2 = 0x1.0b4611a6p-34,
                     kPart3 = 0x1.3198a2e037073p-69;
    const Scalar first = angle_rad - quarters * kPart1;  // exact
    const Scalar second = first - quarters * kPart2, third = quarters * kPart3;
    const Scalar r = second - third;
    const Scalar rest = (first - second - quarters * kPart2) + (second - r - third);
    const Scalar s_r = SineNearZero(r), c_r = CosineNearZero(r);
    return {s_r + rest * c_r, c_r - rest * s_r};  // of r + rest
  }

  static constexpr SineCosine OfQuarter(int n, const SineCosine& near) noexcept {
    switch (n & 3) {
      case 0:
        return {near.sine, near.cosine};
      case 1:
        return {near.cosine, -near.sine};
      case 2:
        return {-near.sine, -near.cosine};
      default:
        return {-near.cosine, near.sine};
    }
  }

  static constexpr int Nearest(double x) noexcept {
    const double beyond = x + (x < 0.0 ? -0.5 : 0.5);
    return static_cast<int>(beyond);
  }

  // |x| <= pi/4 (1 + 1e-15). First term left out: x^18 / 19! < 1e-19 of the result.
  template <typename Scalar>
  static constexpr Scalar SineNearZero(const Scalar& x) noexcept {
    constexpr double k3 = -1.0 / 6.0, k5 = 1.0 / 120.0, k7 = -1.0 / 5040.0, k9 = 1.0 / 362880.0,
                     k11 = -1.0 / 39916800.0, k13 = 1.0 / 6227020800.0,
                     k15 = -1.0 / 1307674368000.0, k17 = 1.0 / 355687428096000.0;
    const Scalar z = x * x;
    const Scalar p =
        k3 + z * (k5 + z * (k7 + z * (k9 + z * (k11 + z * (k13 + z * (k15 + z * k17))))));
    return x + x * z * p;
  }

  // First term left out: x^18 / 18! < 3e-18. 1 - z/2 is rounded once and its error added back.
  template <typename Scalar>
  static constexpr Scalar CosineNearZero(const Scalar& x) noexcept {
    constexpr double k4 = 1.0 / 24.0, k6 = -1.0 / 720.0, k8 = 1.0 / 40320.0, k10 = -1.0 / 3628800.0,
                     k12 = 1.0 / 479001600.0, k14 = -1.0 / 87178291200.0,
                     k16 = 1.0 / 20922789888000.0;
    const Scalar z = x * x;
    const Scalar p = k4 + z * (k6 + z * (k8 + z * (k10 + z * (k12 + z * (k14 + z * k16)))));
    const Scalar half = 0.5 * z, top = 1.0 - half;
    return top + ((1.0 - top - half) + z * z * p);
  }

  // e^x - 1 for 0 <= x <= 40, as 2^n e^r - 1 with |r| <= ln(2)/2.
  static constexpr double ExpMinus1(double x) noexcept {
    if (!(x >= 0.0)) return x;                                                  // NaN
    constexpr double kPart1 = 0x1.62e42fefp-1, kPart2 = 0x1.473de6af278edp-34;  // ln(2)
    constexpr double kPerDoubling = 0x1.71547652b82fep+0;                       // 1/ln(2)
    const int n = Nearest(x * kPerDoubling);
    const double r = x - n * kPart1 - n * kPart2;
    double p = 1.0 / 14.0;
    for (int k = 13; k >= 2; --k) p = (1.0 + r * p) / k;  // r (1 + r/2 (1 + r/3 (..)))
    const double small = r + r * r * p;
    const std::uint64_t exponent = 1023U + static_cast<unsigned>(n);
    const double power = std::bit_cast<double>(exponent << 52U);  // 2^n
    return power * small + (power - 1.0);
  }
};

}  // namespace flexarm
