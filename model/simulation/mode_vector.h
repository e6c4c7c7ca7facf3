#pragma once

#include <array>
#include <cstddef>

#include "model/math/lanes.h"

namespace flexarm {

/// A vector of M numbers, padded with zeros to whole groups of four. Real-time: safe.
template <int M>
class ModeVector {
 public:
  static constexpr std::size_t kGroups = (M + 3) / 4;

  /// Not initialised.
  ModeVector() = default;

  /// Of entry(0) .. entry(M - 1).
  template <typename Entry>
  static ModeVector Of(Entry entry) noexcept {
    const auto padded = [&entry](int i) { return i < M ? entry(i) : 0.0; };
    ModeVector x;
    for (std::size_t group = 0; group < kGroups; ++group) {
      const int first = static_cast<int>(group * Lanes::kCount);
      x.group_[group] =
          Lanes(padded(first), padded(first + 1), padded(first + 2), padded(first + 3));
    }
    return x;
  }

  double operator[](int i) const noexcept {
    const auto at = static_cast<std::size_t>(i);
    return group_[at / Lanes::kCount][at % Lanes::kCount];
  }

  /// Scalar product.
  double Dot(const ModeVector& y) const noexcept {
    Lanes sum = group_[0] * y.group_[0];
    for (std::size_t i = 1; i < kGroups; ++i) sum += group_[i] * y.group_[i];
    return (sum[0] + sum[1]) + (sum[2] + sum[3]);
  }

  friend ModeVector operator+(const ModeVector& x, const ModeVector& y) noexcept {
    ModeVector sum;
    for (std::size_t i = 0; i < kGroups; ++i) sum.group_[i] = x.group_[i] + y.group_[i];
    return sum;
  }
  friend ModeVector operator-(const ModeVector& x, const ModeVector& y) noexcept {
    ModeVector difference;
    for (std::size_t i = 0; i < kGroups; ++i) difference.group_[i] = x.group_[i] - y.group_[i];
    return difference;
  }
  friend ModeVector operator*(double factor, const ModeVector& x) noexcept {
    ModeVector product;
    for (std::size_t i = 0; i < kGroups; ++i) product.group_[i] = Lanes(factor) * x.group_[i];
    return product;
  }

 private:
  std::array<Lanes, kGroups> group_;
};

/// A constant matrix that takes M numbers to R.
///
/// Kept by columns, so that a product is a sum of columns, of which four entries are computed at
/// once. The columns are summed in pairs: the processor does not wait for one sum after another.
/// Real-time: the product is safe.
template <int R, int M>
class ModeMap {
 public:
  /// @param A  R x M
  template <typename Matrix>
  explicit ModeMap(const Matrix& A) noexcept {
    for (int j = 0; j < M; ++j) {
      column_[static_cast<std::size_t>(j)] = ModeVector<R>::Of([&](int i) { return A(i, j); });
    }
  }

  ModeVector<R> operator*(const ModeVector<M>& x) const noexcept { return Sum<0, M>(x); }

 private:
  template <int kFirst, int kCount>
  ModeVector<R> Sum(const ModeVector<M>& x) const noexcept {
    if constexpr (kCount == 1) {
      return x[kFirst] * column_[kFirst];
    } else {
      constexpr int kHalf = kCount / 2;
      return Sum<kFirst, kHalf>(x) + Sum<kFirst + kHalf, kCount - kHalf>(x);
    }
  }

  std::array<ModeVector<R>, static_cast<std::size_t>(M)> column_;
};

}  // namespace flexarm
