#pragma once

#include <Eigen/Core>
#include <cstddef>

namespace flexarm {

/// Sum of multiples of columns: the product of a small matrix with a vector.
///
/// The sums stay in registers. Eigen's lazyProduct of two 16 x 16 matrices takes twice the
/// instructions, as it loads each entry of the second factor again for every two rows of the first.
/// Terms are added in the order of the calls. Columns are those of matrices with an even number of
/// rows, from an even row on, so that they are aligned. Real-time: safe.
/// @tparam kRows  4, 8, .. 24: more would not fit 16 registers, of four or, but for 24, of two
template <int kRows>
class ColumnSum {
  static_assert(kRows % 4 == 0 && kRows <= 24);

 public:
  ColumnSum() noexcept {
    for (Four& four : sum_) four = Four{};
  }

  /// Starts with this column instead of zero.
  explicit ColumnSum(const double* column) noexcept {
    const Four* fours = Fours(column);
    for (std::size_t i = 0; i < kFours; ++i) sum_[i] = fours[i];
  }

  void Add(double factor, const double* column) noexcept {
    const Four* fours = Fours(column);
    const Four factors{factor, factor, factor, factor};
    for (std::size_t i = 0; i < kFours; ++i) sum_[i] += factors * fours[i];
  }

  void WriteTo(double* column) const noexcept {
    Four* fours = reinterpret_cast<Four*>(column);
    for (std::size_t i = 0; i < kFours; ++i) fours[i] = sum_[i];
  }

 private:
  using Four [[gnu::vector_size(32), gnu::may_alias, gnu::aligned(16)]] = double;
  static constexpr std::size_t kFours = kRows / 4;

  static const Four* Fours(const double* column) noexcept {
    return reinterpret_cast<const Four*>(column);
  }

  // NOLINTNEXTLINE(modernize-avoid-c-arrays): std::array would drop the attributes of Four
  Four sum_[kFours];
};

/// A B. Real-time: safe.
template <int kRows, int kInner, int kColumns>
Eigen::Matrix<double, kRows, kColumns> ColumnProduct(
    const Eigen::Matrix<double, kRows, kInner>& A,
    const Eigen::Matrix<double, kInner, kColumns>& B) noexcept {
  Eigen::Matrix<double, kRows, kColumns> product;
  for (int column = 0; column < kColumns; ++column) {
    ColumnSum<kRows> sum;
    for (int k = 0; k < kInner; ++k) sum.Add(B(k, column), A.col(k).data());
    sum.WriteTo(product.col(column).data());
  }
  return product;
}

}  // namespace flexarm
