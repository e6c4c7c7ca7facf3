#include "model/math/matrix_scaling.h"

#include <cmath>

namespace flexarm {

Eigen::VectorXd BalancingScale(Eigen::MatrixXd A) {
  Eigen::VectorXd scale = Eigen::VectorXd::Ones(A.rows());
  A.diagonal().setZero();
  for (int sweep = 0; sweep < 20; ++sweep) {
    bool changed = false;
    for (Eigen::Index i = 0; i < A.rows(); ++i) {
      const double column = A.col(i).lpNorm<1>(), row = A.row(i).lpNorm<1>();
      if (column == 0.0 || row == 0.0) continue;
      const double f = std::exp2(std::round(0.5 * std::log2(row / column)));
      if (f == 1.0) continue;
      A.col(i) *= f;
      A.row(i) /= f;
      scale[i] *= f;
      changed = true;
    }
    if (!changed) break;
  }
  return scale;
}

}  // namespace flexarm
