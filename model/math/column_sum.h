#pragma once

#include <cstddef>

namespace flexarm {

/// Sum of multiples of columns: the product of a small matrix with a vector.
///
/// The sums stay in registers. Eigen's lazyProduct of two 16 x 16 matrices takes twice the
/// instructions, as it loads each entry of the second factor again for every two rows of the first.
/// Terms are added in the order of the calls. Columns are those of matrices with an even number of
/// rows, from an even row on, so that they are aligned. Real-time: safe.
/// @tparam kRows  even, at most 20: more would not fit 16 registers
template <int kRows>
class ColumnSum {
  static_assert(kRows % 2 == 0 && kRows <= 20);

 public:
  ColumnSum() noexcept {
    for (Pair& pair : sum_) pair = Pair{0.0, 0.0};
  }

  /// Starts with this column instead of zero.
  explicit ColumnSum(const double* column) noexcept {
    const Pair* pairs = Pairs(column);
    for (std::size_t i = 0; i < kPairs; ++i) sum_[i] = pairs[i];
  }

  void Add(double factor, const double* column) noexcept {
    const Pair* pairs = Pairs(column);
    const Pair factors{factor, factor};
    for (std::size_t i = 0; i < kPairs; ++i) sum_[i] += factors * pairs[i];
  }

  void WriteTo(double* column) const noexcept {
    Pair* pairs = reinterpret_cast<Pair*>(column);
    for (std::size_t i = 0; i < kPairs; ++i) pairs[i] = sum_[i];
  }

 private:
  using Pair = double __attribute__((vector_size(16), may_alias));
  static constexpr std::size_t kPairs = kRows / 2;

  static const Pair* Pairs(const double* column) noexcept {
    return reinterpret_cast<const Pair*>(column);
  }

  Pair sum_[kPairs];
};

}  // namespace flexarm
