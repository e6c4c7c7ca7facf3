#pragma once

#include <Eigen/Core>

#include "model/parameters/arm_parameters.h"

namespace flexarm {

/// Exact dynamic stiffness of a section at omega: [w0 w0' wl wl'] -> forces at its ends, for a beam
/// that is free at both. Symmetric.
/// @param omega_rad_s  > 0
Eigen::Matrix4d SectionStiffness(const BeamSection& s, double omega_rad_s);

/// Number of natural frequencies below omega of a section that is clamped at both ends.
int CountClampedClamped(const BeamSection& s, double omega_rad_s);

/// Of a symmetric matrix; its rows and columns are scaled first.
int CountNegativeEigenvalues(const Eigen::MatrixXd& K);

}  // namespace flexarm
