#include "estimator/filter_covariance.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "model/math/column_sum.h"
#include "model/math/mirror_lower_half.h"
#include "model/math/wide_instructions.h"

namespace flexarm {
namespace {

using FilterSquare = FilterCovariance::Square;

FilterSquare Padded(const Eigen::MatrixXd& M) {
  const Eigen::Index rows = (M.rows() + 3) / 4 * 4;
  FilterSquare padded = FilterSquare::Zero(rows, rows);
  padded.topLeftCorner(M.rows(), M.cols()) = M;
  return padded;
}

// Column `column` of A B + C from row kFirst on, all padded; without C where that is null.
template <int kRows, int kFirst>
void ProductColumn(const FilterSquare& A, const FilterSquare& B, const FilterSquare* C, int column,
                   FilterSquare* product) noexcept {
  ColumnSum<kRows - kFirst> sum;
  if (C != nullptr) sum = ColumnSum<kRows - kFirst>(C->col(column).data() + kFirst);
#pragma GCC unroll 4
  for (int k = 0; k < kRows; ++k) sum.Add(B(k, column), A.col(k).data() + kFirst);
  sum.WriteTo(product->col(column).data() + kFirst);
}

// A B + C on and below the diagonal, and in parts above it.
template <int kRows, int kFirst = 0>
void LowerProduct(const FilterSquare& A, const FilterSquare& B, const FilterSquare* C,
                  FilterSquare* product) noexcept {
  constexpr int kBlock = 4;
  for (int column = kFirst; column < kFirst + kBlock; ++column) {
    ProductColumn<kRows, kFirst>(A, B, C, column, product);
  }
  if constexpr (kFirst + kBlock < kRows) {
    LowerProduct<kRows, kFirst + kBlock>(A, B, C, product);
  }
}

// A covariance and a state that outputs correct one after the other, which equals all at once. An
// output is a row c with few entries. P is corrected by all of them at the end: until then what
// counts of it is its product with each c.
template <int kRows>
class Correction {
 public:
  Correction(const FilterSquare& P, double* x) noexcept : P_(P), x_(x) {}

  void Add(double y, const FilterCovariance::Output& output) noexcept {
    ColumnSum<kRows> product;
    double predicted = 0.0;
    for (const auto& [state, factor] : output.row) {
      product.Add(factor, P_.data() + state * kRows);
      predicted += factor * x_[state];
    }
    for (std::size_t before = 0; before < outputs_; ++before) {
      product.Add(-Dot(output, product_[before]), gain_[before].data());
    }
    Column& Pc = product_[outputs_];
    Column& gain = gain_[outputs_++];
    product.WriteTo(Pc.data());
    const double variance = output.variance + Dot(output, Pc);
    for (std::size_t k = 0; k < kRows; ++k) gain[k] = Pc[k] / variance;
    ColumnSum<kRows> corrected(x_);
    corrected.Add(y - predicted, gain.data());
    corrected.WriteTo(x_);
  }

  void Finish(FilterSquare* P) const noexcept {
    for (std::size_t column = 0; column < kRows; ++column) {
      double* const to = P->data() + column * kRows;
      ColumnSum<kRows> left(to);
      for (std::size_t i = 0; i < outputs_; ++i) left.Add(-product_[i][column], gain_[i].data());
      left.WriteTo(to);
    }
  }

 private:
  struct alignas(16) Column : std::array<double, std::size_t{kRows}> {};

  static double Dot(const FilterCovariance::Output& output, const Column& column) noexcept {
    double sum = 0.0;
    for (const auto& [state, factor] : output.row) sum += factor * column[state];
    return sum;
  }

  const FilterSquare& P_;
  double* const x_;
  std::size_t outputs_ = 0;
  std::array<Column, FilterCovariance::Outputs::MaxRowsAtCompileTime> product_, gain_;
};

}  // namespace

FilterCovariance::FilterCovariance(const Eigen::MatrixXd& A, const Eigen::MatrixXd& C,
                                   const Eigen::MatrixXd& W, const Eigen::VectorXd& R,
                                   const Eigen::MatrixXd& steady)
    : A_(Padded(A)),
      A_transposed_(A_.transpose()),
      W_(Padded(W)),
      steady_(Padded(steady)),
      P_(steady_) {
  for (Eigen::Index i = 0; i < C.rows(); ++i) {
    Output output{.row = {}, .variance = R(i)};
    for (Eigen::Index k = 0; k < C.cols(); ++k) {
      if (C(i, k) != 0.0) output.row.push_back({static_cast<std::size_t>(k), C(i, k)});  // start-up
    }
    outputs_.push_back(std::move(output));  // start-up
  }
}

void FilterCovariance::Correct(const Outputs& y, std::uint32_t good, bool complete,
                               State* x) noexcept {
  if (steady()) P_ = steady_;
  settled_ = complete ? settled_ + 1 : 0;
  CorrectPadded(y, good, complete, x);
}

FLEXARM_WIDE_INSTRUCTIONS
void FilterCovariance::CorrectPadded(const Outputs& y, std::uint32_t good, bool complete,
                                     State* x) noexcept {
  switch (P_.rows() / 4) {
    case 1:
      return CorrectRows<4>(y, good, complete, x);
    case 2:
      return CorrectRows<8>(y, good, complete, x);
    case 3:
      return CorrectRows<12>(y, good, complete, x);
    case 4:
      return CorrectRows<16>(y, good, complete, x);
    case 5:
      return CorrectRows<20>(y, good, complete, x);
    default:
      return CorrectRows<24>(y, good, complete, x);
  }
}

template <int kRows>
void FilterCovariance::CorrectRows(const Outputs& y, std::uint32_t good, bool complete,
                                   State* x) noexcept {
  const Eigen::Index n = x->size();
  alignas(16) std::array<double, std::size_t{kRows}> padded{};
  std::copy_n(x->data(), n, padded.data());
  Correction<kRows> correction(P_, padded.data());
  for (Eigen::Index i = 0; i < y.size(); ++i) {
    if ((good >> i & 1u) != 0) correction.Add(y(i), outputs_[static_cast<std::size_t>(i)]);
  }
  correction.Finish(&P_);
  std::copy_n(padded.data(), n, x->data());
  FilterSquare AP(kRows, kRows);
  for (int column = 0; column < kRows; ++column) {
    ProductColumn<kRows, 0>(A_, P_, nullptr, column, &AP);
  }
  LowerProduct<kRows>(AP, A_transposed_, complete ? &W_ : nullptr, &P_);
  MirrorLowerHalf<kRows>(kRows, P_.data());
}

}  // namespace flexarm
