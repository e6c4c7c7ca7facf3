#pragma once

#include <Eigen/Core>
#include <vector>

#include "model/beam/beam_modes.h"

namespace flexarm {

/// beta = (w^2 rho A/(EI))^(1/4) of a section, 1/m.
double Beta(const BeamSection& s, double omega_rad_s);

/// The four basis functions of a section (beam_basis.h) at x from its root end.
/// @param order  derivative, 0..3; in SI units, 1/m^order
Eigen::RowVector4d BasisRow(const BeamSection& s, double omega_rad_s, double x_m, int order);

/// Static stiffness of a part of length l, [w0 w0' wl wl'] -> end forces (Hermite's cubics).
Eigen::Matrix4d StaticStiffness(double length_m, double bending_stiffness_nm2);

/// Homogeneous conditions on the four coefficients of each section: root (rows 0 and 1: w(0), and
/// w'(0) or its moment), continuity, tip. Rows scaled to a largest entry of 1. Singular at a
/// natural frequency.
Eigen::MatrixXd MatchingMatrix(const std::vector<BeamSection>& section, const BeamTip& tip,
                               double omega_rad_s, BeamRoot root = BeamRoot::Clamped());

}  // namespace flexarm
