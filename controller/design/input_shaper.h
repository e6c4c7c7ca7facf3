#pragma once

#include <Eigen/Core>

namespace flexarm {

/// Input shaper: weights with which a convolved command leaves no residual vibration.
///
/// For each of the two slowest oscillations of the closed loop, impulses half a damped period apart
/// with weights 1, K (zero vibration, ZV) or 1, 2K, K^2 (zero vibration and derivative, ZVD),
/// K = exp(-zeta pi / sqrt(1 - zeta^2)), scaled to the sum 1; the two are convolved. An impulse
/// between two samples is divided between them, so that its mean instant is kept. Sources: Singer
/// and Seering, ASME J. Dynamic Systems 112 (1990) 76; Singhose's survey (2009).
/// @param closed       discrete closed loop, stable, with at least two oscillations
/// @param derivatives  1: ZV, 2: ZVD
/// @return weight of the sample i periods ago; not negative, sum 1
/// @throws std::runtime_error if it has fewer than two oscillations
Eigen::RowVectorXd DesignInputShaper(const Eigen::MatrixXd& closed, int derivatives);

}  // namespace flexarm
