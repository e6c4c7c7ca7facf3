#include "estimator/filter_covariance.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "model/math/column_sum.h"
#include "model/math/wide_instructions.h"

namespace flexarm {
namespace {

using FilterSquare = FilterCovariance::Square;

FilterSquare Padded(const Eigen::MatrixXd& M, Eigen::Index columns) {
  FilterSquare padded = FilterSquare::Zero((M.rows() + 3) / 4 * 4, columns);
  padded.topLeftCorner(M.rows(), M.cols()) = M;
  return padded;
}

FilterSquare Padded(const Eigen::MatrixXd& M) { return Padded(M, (M.cols() + 3) / 4 * 4); }

// Column `column` of A B from row kFirst on, both padded.
template <int kRows, int kFirst>
void ProductColumn(const FilterSquare& A, const FilterSquare& B, int column,
                   FilterSquare* product) noexcept {
  ColumnSum<kRows - kFirst> sum;
#pragma GCC unroll 4
  for (int k = 0; k < kRows; ++k) sum.Add(B(k, column), A.col(k).data() + kFirst);
  sum.WriteTo(product->col(column).data() + kFirst);
}

// A B, where that is symmetric: the half below the diagonal, which the other one mirrors.
template <int kRows, int kFirst = 0>
void SymmetricProduct(const FilterSquare& A, const FilterSquare& B,
                      FilterSquare* product) noexcept {
  constexpr int kBlock = 4;
  for (int column = kFirst; column < kFirst + kBlock; ++column) {
    ProductColumn<kRows, kFirst>(A, B, column, product);
    for (int row = kFirst + kBlock; row < kRows; ++row) {
      (*product)(column, row) = (*product)(row, column);
    }
  }
  for (int column = 0; column < kBlock; ++column) {
    for (int row = column + 1; row < kBlock; ++row) {
      (*product)(kFirst + column, kFirst + row) = (*product)(kFirst + row, kFirst + column);
    }
  }
  if constexpr (kFirst + kBlock < kRows) {
    SymmetricProduct<kRows, kFirst + kBlock>(A, B, product);
  }
}

// Corrects x and P by one output y = c x, of variance r. Most of c is zero.
template <int kRows>
void CorrectBy(double y, const double* c, double r, double* x, FilterSquare* P) noexcept {
  ColumnSum<kRows> sum;
  double predicted = 0.0;
  for (int k = 0; k < kRows; ++k) {
    if (c[k] == 0.0) continue;
    sum.Add(c[k], P->col(k).data());
    predicted += c[k] * x[k];
  }
  alignas(16) std::array<double, std::size_t{kRows}> Pc, gain;
  sum.WriteTo(Pc.data());
  double variance = r;
  for (std::size_t k = 0; k < kRows; ++k) {
    if (c[k] != 0.0) variance += c[k] * Pc[k];
  }
  for (std::size_t k = 0; k < kRows; ++k) gain[k] = Pc[k] / variance;
  ColumnSum<kRows> corrected(x);
  corrected.Add(y - predicted, gain.data());
  corrected.WriteTo(x);
  for (int column = 0; column < kRows; ++column) {
    ColumnSum<kRows> left(P->col(column).data());
    left.Add(-Pc[static_cast<std::size_t>(column)], gain.data());
    left.WriteTo(P->col(column).data());
  }
}

}  // namespace

FilterCovariance::FilterCovariance(const Eigen::MatrixXd& A, const Eigen::MatrixXd& C,
                                   const Eigen::MatrixXd& W, const Eigen::VectorXd& R,
                                   const Eigen::MatrixXd& steady)
    : A_(Padded(A)),
      A_transposed_(A_.transpose()),
      W_(Padded(W)),
      steady_(Padded(steady)),
      C_transposed_(Padded(C.transpose(), C.rows())),
      R_(R),
      P_(steady_) {}

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
  for (Eigen::Index i = 0; i < y.size(); ++i) {
    if ((good >> i & 1u) == 0) continue;
    CorrectBy<kRows>(y(i), C_transposed_.col(i).data(), R_(i), padded.data(), &P_);
  }
  std::copy_n(padded.data(), n, x->data());
  FilterSquare AP(kRows, kRows);
  for (int column = 0; column < kRows; ++column) ProductColumn<kRows, 0>(A_, P_, column, &AP);
  SymmetricProduct<kRows>(AP, A_transposed_, &P_);
  if (complete) P_ += W_;
}

}  // namespace flexarm
