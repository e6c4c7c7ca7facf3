#include "estimator/filter_covariance.h"

namespace flexarm {
namespace {

using FilterSquare = FilterCovariance::Square;
using FilterState = FilterCovariance::State;
using Four = Eigen::Array<double, 4, 1>;

FilterSquare Padded(const Eigen::MatrixXd& M, Eigen::Index columns) {
  FilterSquare padded = FilterSquare::Zero((M.rows() + 3) / 4 * 4, columns);
  padded.topLeftCorner(M.rows(), M.cols()) = M;
  return padded;
}

FilterSquare Padded(const Eigen::MatrixXd& M) { return Padded(M, (M.cols() + 3) / 4 * 4); }

Eigen::Map<Four> FourOf(double* x) noexcept { return Eigen::Map<Four>(x); }
Eigen::Map<const Four> FourOf(const double* x) noexcept { return Eigen::Map<const Four>(x); }

// A B, both padded. Sixteen sums stay in registers; Eigen's lazy products take twice the
// instructions, and its others may use the heap.
FilterSquare Product(const FilterSquare& A, const FilterSquare& B) noexcept {
  const Eigen::Index n = A.rows();
  FilterSquare product(n, n);
  for (Eigen::Index column = 0; column < n; column += 4) {
    const double* const b = B.data() + column * n;
    for (Eigen::Index row = 0; row < n; row += 4) {
      Four sum0 = Four::Zero(), sum1 = Four::Zero(), sum2 = Four::Zero(), sum3 = Four::Zero();
      const double* a = A.data() + row;
      for (Eigen::Index k = 0; k < n; ++k, a += n) {
        const Four four = FourOf(a);
        sum0 += four * b[k];
        sum1 += four * b[k + n];
        sum2 += four * b[k + 2 * n];
        sum3 += four * b[k + 3 * n];
      }
      double* const to = product.data() + column * n + row;
      FourOf(to) = sum0;
      FourOf(to + n) = sum1;
      FourOf(to + 2 * n) = sum2;
      FourOf(to + 3 * n) = sum3;
    }
  }
  return product;
}

// P c, where most of c is zero.
FilterState ProductWithSparse(const FilterSquare& P, const double* c) noexcept {
  const Eigen::Index n = P.rows();
  FilterState product = FilterState::Zero(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    if (c[k] == 0.0) continue;
    for (Eigen::Index row = 0; row < n; row += 4) {
      FourOf(product.data() + row) += FourOf(P.data() + k * n + row) * c[k];
    }
  }
  return product;
}

// P - x y'
void Subtract(const FilterState& x, const FilterState& y, FilterSquare* P) noexcept {
  const Eigen::Index n = P->rows();
  for (Eigen::Index column = 0; column < n; ++column) {
    for (Eigen::Index row = 0; row < n; row += 4) {
      FourOf(P->data() + column * n + row) -= FourOf(x.data() + row) * y(column);
    }
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
  const Eigen::Index n = x->size();
  for (Eigen::Index i = 0; i < y.size(); ++i) {
    if ((good >> i & 1u) == 0) continue;
    const auto c = C_transposed_.col(i);
    const State Pc = ProductWithSparse(P_, c.data());
    const double variance = c.dot(Pc) + R_(i);
    const State gain = Pc / variance;
    *x += gain.head(n) * (y(i) - c.head(n).dot(*x));
    Subtract(gain, Pc, &P_);
  }
  P_ = Product(Product(A_, P_), A_transposed_);
  if (complete) P_ += W_;
  P_ = (0.5 * (P_ + P_.transpose())).eval();  // symmetric in spite of rounding
}

}  // namespace flexarm
