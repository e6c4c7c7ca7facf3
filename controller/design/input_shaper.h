#pragma once

#include <Eigen/Core>

namespace flexarm {

/// Weights of an input shaper: a command convolved with them leaves no vibration behind.
///
/// For each of the two slowest oscillations of the closed loop, impulses half a damped period apart
/// with weights 1, K (zero vibration, ZV) or 1, 2K, K^2 (zero vibration and derivative, ZVD),
/// K = exp(-zeta pi / sqrt(1 - zeta^2)), scaled to the sum 1; both convolved. An impulse between
/// two samples is shared by them, so that its instant is kept on average. Sources: Singer and
/// Seering, ASME J. Dynamic Systems 112 (1990) 76; Singhose's survey (2009).
/// @param closed       discrete closed loop, stable, with at least two oscillations
/// @param derivatives  1: ZV, 2: ZVD
/// @return weight of the sample i periods ago; not negative, sum 1
/// @throws std::runtime_error if it does not oscillate
Eigen::RowVectorXd DesignInputShaper(const Eigen::MatrixXd& closed, int derivatives);

}  // namespace flexarm
