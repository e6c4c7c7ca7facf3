#pragma once

#include <Eigen/Core>
#include <vector>

#include "model/beam/link_modes.h"

namespace flexarm {

/// Position and weight of a strain channel of one link.
struct StrainStation {
  double position_m;        ///< from the root
  double half_thickness_m;  ///< h/2 there
  double weight;            ///< 1 / variance of its strain
};

inline constexpr int kPolynomialTerms = 5;

/// The thesis's map from strains to bending (B.1), (B.2), as one matrix: modal coordinates per unit
/// strain, modes x stations.
///
///   w(u) = a1 u^2 + a2 u^3 + a3 u^4 + a4 u^5 + a5 u^6,  strain_i = (h/2) w''(x_i)
///
/// The a's by weighted least squares (at five stations exactly, as in the thesis), then the modal
/// coordinates by least squares of sum_j psi_j f_j to w over the link. The direct fit of modes
/// (strain_fit.h) uses the mode shapes; this one assumes only that the deflection is smooth, and
/// attributes the deflection of other modes to the first ones.
/// @param station  five or more, at five different positions at least
/// @param modes    number of modal coordinates, at most the modes of `link`
Eigen::MatrixXd PolynomialModalMap(const LinkModes& link, const std::vector<StrainStation>& station,
                                   int modes);

}  // namespace flexarm
