#pragma once

#include <Eigen/Core>
#include <vector>

#include "model/beam_modes.h"

namespace flexarm {

/// beta = (w^2 rho A/(EI))^(1/4) of a section, 1/m.
double Beta(const BeamSection& s, double omega_rad_s);

/// The four basis functions of a section (beam_basis.h) at x from its root end.
/// @param order  derivative, 0..3; in SI units, 1/m^order
Eigen::RowVector4d BasisRow(const BeamSection& s, double omega_rad_s, double x_m, int order);

/// Homogeneous conditions on the four coefficients of each section: clamp (rows 0 and 1: w(0),
/// w'(0)), continuity, tip. Rows scaled to a largest entry of 1. Singular at a natural frequency.
Eigen::MatrixXd MatchingMatrix(const std::vector<BeamSection>& section, const BeamTip& tip,
                               double omega_rad_s);

}  // namespace flexarm
