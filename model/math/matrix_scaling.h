#pragma once

#include <Eigen/Core>

namespace flexarm {

/// Powers of two t that balance the norms of rows and columns of T^-1 A T, T = diag(t), so that
/// mixed units (rad, m, N/m) lose no digits.
///
/// Source: Parlett and Reinsch 1969. Real-time: start-up only (allocates).
Eigen::VectorXd BalancingScale(Eigen::MatrixXd A);

}  // namespace flexarm
