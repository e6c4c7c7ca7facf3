#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "model/beam/beam_modes.h"
#include "model/parameters/arm_parameters.h"

namespace flexarm {

/// Mode shapes of one link and the integrals over it that the equations of motion need.
///
/// lam = rho A. Tip terms are not included: only the distributed mass of the link.
/// Integrals by 10-point Gauss-Legendre on panels of beta*l <= 2: relative error below 1e-13.
struct LinkModes {
  std::vector<BeamMode> mode;
  Eigen::VectorXd a;          ///< int lam u psi, kg m
  Eigen::VectorXd k;          ///< int lam psi, kg
  Eigen::VectorXd psi_tip;    ///< psi(L) = 1
  Eigen::VectorXd slope_tip;  ///< psi'(L), 1/m
  Eigen::MatrixXd N;          ///< int lam psi_i psi_j, kg
  Eigen::MatrixXd G;          ///< int EI psi_i'' psi_j'', N/m
  Eigen::MatrixXd D;          ///< structural damping, N s/m: int C_a I psi_i'' psi_j'' or modal
  double m;                   ///< int lam, kg
  double first_moment;        ///< int lam u, kg m
  double second_moment;       ///< int lam u^2, kg m^2
  double length_m;
  double panel_m;  ///< beta * panel_m = 2 for the shortest wave: quadrature panels

  int count() const { return static_cast<int>(mode.size()); }
};

/// Lumped mass and inertia at the tip of link 1 for which its shapes are computed.
BeamTip Link1Tip(const ArmParameters& p);

/// Lumped mass and inertia at the tip of link 2 for which its shapes are computed.
BeamTip Link2Tip(const ArmParameters& p);

/// Link 1: clamped; its tip carries motor 2, hub 2, link 2 and the payload as a mass, and the
/// rotary inertia chosen by `link1_tip_inertia` (link 2 hangs on a free joint).
/// @throws std::invalid_argument as ClampedModes.
LinkModes Link1Modes(const ArmParameters& p, int count);

/// Link 2: clamped to hub 2; its tip carries `shape_payload_mass_kg` and the payload's inertia.
LinkModes Link2Modes(const ArmParameters& p, int count);

/// int_0^L f(x, section) dx by Gauss-Legendre on panels no longer than `panel_m`.
double IntegrateAlong(const std::vector<BeamSection>& section, double panel_m,
                      const std::function<double(double, const BeamSection&)>& f);

}  // namespace flexarm
