#pragma once

#include <vector>

#include "model/beam/beam_modes.h"
#include "model/parameters/arm_parameters.h"

namespace flexarm {

/// Sides of a solid rectangular section, from its area and its second moment in the plane of
/// motion: thickness h = sqrt(12 I / A) along the motion, width b = A / h across it.
struct RectangularSection {
  double width_m = 0.0, thickness_m = 0.0;

  explicit RectangularSection(const BeamSection& s);

  /// I_t of Saint-Venant's torsion, m^4: b h^3/3 (1 - 192/pi^5 h/b sum_odd tanh(n pi b/(2 h))/n^5)
  /// with h the shorter side.
  /// Source: Timoshenko and Goodier, Theory of Elasticity, 1970, art. 109.
  double TorsionConstant_m4() const;
  /// Second moment of bending out of the plane of motion, h b^3 / 12, m^4.
  double SecondMomentAcross_m4() const;
};

/// What hangs at the end of a twisting link: a mass beside its axis, in the direction across the
/// plane of motion.
struct TwistTip {
  BeamTip bending;            ///< mass, and inertia about the axis across the plane
  double offset_m;            ///< e: distance of the mass from the link's axis
  double axial_inertia_kgm2;  ///< about the link's axis, of a body through whose centre it passes
};

/// A link that bends in the plane of motion and twists about its axis, clamped at its root.
///
/// Saint-Venant torsion, G I_t phi'' + w^2 rho (I + I_across) phi = 0; no warping restraint. Only
/// the offset of the tip mass couples the two: its deflection is w + e phi. Exact by dynamic
/// stiffness, as ExactArm. Not modelled: gravity, damping, bending across the plane.
class TwistingLink {
 public:
  /// @param poisson  of the material, G = E / (2 (1 + nu)); -1 < nu < 0.5
  /// @throws std::invalid_argument otherwise, or if there is no section
  TwistingLink(const std::vector<BeamSection>& section, double poisson);

  double length_m() const { return length_m_; }
  /// Torque at the tip for a twist of the tip of 1 rad, N m/rad.
  double Stiffness_nm_per_rad() const;
  /// Force across the plane at the tip for a deflection there of 1 m, N/m: how the link carries
  /// weight.
  double StiffnessAcross_n_per_m() const;
  /// The lowest frequency of pure torsion with an inertia at the tip, Hz.
  double TorsionHz(double axial_inertia_kgm2) const;
  /// The lowest `count` frequencies of bending and torsion together, Hz.
  std::vector<double> CoupledHz(const TwistTip& tip, int count) const;
  /// Twist of the tip per deflection of the link's axis there, in a mode of CoupledHz, rad/m.
  double TwistPerDeflection_rad_per_m(const TwistTip& tip, double frequency_hz) const;

 private:
  struct Part {
    BeamSection bending;
    double shaft_nm2;    ///< G I_t
    double inertia_kgm;  ///< rho (I + I_across)
  };

  int CountBelow(double omega_rad_s, const TwistTip& tip, bool bends) const;
  double TorsionEnd(double omega_rad_s) const;

  std::vector<Part> part_;
  double length_m_ = 0.0;
};

}  // namespace flexarm
