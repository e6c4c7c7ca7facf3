#pragma once

#include <cmath>
#include <cstddef>

namespace Eigen {
template <typename Scalar>
struct NumTraits;
}

namespace flexarm {

/// Four numbers in place of one: code that is a template of its scalar computes four cases at once.
///
/// Each lane gets what a double would, to the bit: + - * / and sqrt act on each by itself. The
/// processor does two lanes with one instruction. A branch on a value has no meaning for four;
/// such code takes the lanes apart. Real-time: safe.
struct Lanes {
  static constexpr std::size_t kCount = 4;

  Lanes() = default;
  /// The same number in all lanes; implicit, so that constants stay doubles.
  Lanes(double x) noexcept : all_{x, x, x, x} {}  // NOLINT(google-explicit-constructor)

  /// One number in each lane.
  Lanes(double x0, double x1, double x2, double x3) noexcept : all_{x0, x1, x2, x3} {}

  double operator[](std::size_t lane) const noexcept { return all_[lane]; }
  void Set(std::size_t lane, double x) noexcept { all_[lane] = x; }

  Lanes& operator+=(const Lanes& y) noexcept {
    all_ += y.all_;
    return *this;
  }
  Lanes& operator-=(const Lanes& y) noexcept {
    all_ -= y.all_;
    return *this;
  }
  Lanes operator-() const noexcept { return Lanes(-all_); }
  friend Lanes operator+(const Lanes& x, const Lanes& y) noexcept { return Lanes(x.all_ + y.all_); }
  friend Lanes operator-(const Lanes& x, const Lanes& y) noexcept { return Lanes(x.all_ - y.all_); }
  friend Lanes operator*(const Lanes& x, const Lanes& y) noexcept { return Lanes(x.all_ * y.all_); }
  friend Lanes operator/(const Lanes& x, const Lanes& y) noexcept { return Lanes(x.all_ / y.all_); }
  // NOLINTNEXTLINE(readability-identifier-naming): found beside std::sqrt, by its name
  friend Lanes sqrt(const Lanes& x) noexcept {
    Lanes roots;
    for (std::size_t lane = 0; lane < kCount; ++lane) roots.Set(lane, std::sqrt(x[lane]));
    return roots;
  }

 private:
  // Aligned as a pair: Eigen aligns no more, and neither do the processor's unaligned loads need
  // it.
  using Four [[gnu::vector_size(32), gnu::aligned(16)]] = double;
  explicit Lanes(const Four& four) noexcept : all_(four) {}

  Four all_;
};

}  // namespace flexarm

/// Eigen's matrices of Lanes: storage and sums of products.
template <>
struct Eigen::NumTraits<flexarm::Lanes> {
  using Real = flexarm::Lanes;
  using NonInteger = flexarm::Lanes;
  using Literal = double;
  using Nested = flexarm::Lanes;
  // NOLINTBEGIN(readability-identifier-naming): names that Eigen asks for
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 0,
    ReadCost = 4,
    AddCost = 2,
    MulCost = 2
  };
  // NOLINTEND(readability-identifier-naming)
};
