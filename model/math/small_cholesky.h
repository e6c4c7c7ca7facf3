#pragma once

#include <Eigen/Core>
#include <cmath>

namespace flexarm {

/// Cholesky factor L of A = L L' for a size known at compile time, at most about 16.
///
/// Eigen's LLT instantiates its blocked algorithm in every size: that costs seconds of compile
/// time, and small systems do not use it or pay for its copies. Sums are taken in the order of
/// Eigen's, so both give the same bits where no fused multiply-add is used. NaN if A is not
/// positive definite. Real-time: safe.
template <int N>
class SmallCholesky {
 public:
  using Matrix = Eigen::Matrix<double, N, N>;

  SmallCholesky() = default;
  template <typename Derived>
  explicit SmallCholesky(const Eigen::MatrixBase<Derived>& A) noexcept {
    Compute(A);
  }

  /// Reads the lower half of A.
  template <typename Derived>
  void Compute(const Eigen::MatrixBase<Derived>& A) noexcept {
    L_ = A;
    for (int k = 0; k < N; ++k) {
      double square = 0.0;
      for (int j = 0; j < k; ++j) square += At(k, j) * At(k, j);
      At(k, k) = std::sqrt(At(k, k) - square);
      for (int i = k + 1; i < N; ++i) {
        double sum = 0.0;
        for (int j = 0; j < k; ++j) sum += At(i, j) * At(k, j);
        At(i, k) = (At(i, k) - sum) / At(k, k);
      }
      inverse_.coeffRef(k) = 1.0 / At(k, k);
    }
  }

  /// The factor; above its diagonal are the entries of A.
  const Matrix& L() const noexcept { return L_; }

  /// X = L^-1 X, for a few columns.
  template <int Columns>
  void SolveLower(Eigen::Matrix<double, N, Columns>* X) const noexcept {
    for (int panel = 0; panel < N; panel += kPanel) {
      const int end = panel + kPanel < N ? panel + kPanel : N;
      for (int column = 0; column < Columns; ++column) {
        double* x = X->col(column).data();
        for (int k = panel; k < end; ++k) {
          x[k] *= inverse_.coeff(k);
          for (int i = k + 1; i < end; ++i) x[i] -= At(i, k) * x[k];
        }
        for (int i = panel + kPanel; i < N; ++i) {
          double sum = 0.0;
          for (int k = panel; k < end; ++k) sum += At(i, k) * x[k];
          x[i] -= sum;
        }
      }
    }
  }

  /// A^-1 B, for a few columns.
  template <int Columns>
  Eigen::Matrix<double, N, Columns> Solve(Eigen::Matrix<double, N, Columns> B) const noexcept {
    SolveLower(&B);
    for (int end = N; end > 0; end -= kPanel) {
      const int start = end > kPanel ? end - kPanel : 0;
      for (int column = 0; column < Columns; ++column) {
        double* x = B.col(column).data();
        for (int i = end - 1; i >= start; --i) {
          double sum = 0.0;
          for (int k = i + 1; k < end; ++k) sum += At(k, i) * x[k];
          x[i] = (x[i] - sum) * inverse_.coeff(i);
        }
        for (int i = 0; i < start; ++i) {
          double sum = 0.0;
          for (int k = start; k < end; ++k) sum += At(k, i) * x[k];
          x[i] -= sum;
        }
      }
    }
    return B;
  }

  /// A^-1 b
  Eigen::Matrix<double, N, 1> Solve(Eigen::Matrix<double, N, 1> b) const noexcept {
    static_assert(N <= 4, "Eigen sums the terms of larger systems in another order");
    double* x = b.data();
    for (int i = 0; i < N; ++i) {
      double sum = 0.0;
      for (int j = i - 1; j >= 0; --j) sum += At(i, j) * x[j];
      x[i] = (x[i] - sum) / At(i, i);
    }
    for (int i = N - 1; i >= 0; --i) {
      double sum = 0.0;
      for (int j = i + 1; j < N; ++j) sum += At(j, i) * x[j];
      x[i] = (x[i] - sum) / At(i, i);
    }
    return b;
  }

 private:
  static constexpr int kPanel = 4;  // columns that Eigen eliminates at a time

  // Without the range check of operator(): sanitizer builds step the planner in real time too.
  double& At(int row, int column) noexcept { return L_.coeffRef(row, column); }
  double At(int row, int column) const noexcept { return L_.coeff(row, column); }

  Matrix L_;
  Eigen::Matrix<double, N, 1> inverse_;  // of L's diagonal
};

}  // namespace flexarm
