#pragma once

#include <array>
#include <limits>
#include <string>
#include <vector>

#include "model/parameters/arm_parameters.h"

namespace flexarm {

/// Lumped mass and inertia at the free end of a beam.
struct BeamTip {
  double mass_kg;       ///< m_t >= 0
  double inertia_kgm2;  ///< J_t >= 0, about the tip point
};

/// Support at the root of a beam, whose deflection is zero there: a torsion spring of any
/// stiffness, EI psi''(0) = k psi'(0).
struct BeamRoot {
  double stiffness_nm_per_rad;  ///< k: 0 pinned, infinite clamped

  static constexpr BeamRoot Clamped() { return {std::numeric_limits<double>::infinity()}; }
  static constexpr BeamRoot Pinned() { return {0.0}; }
  static constexpr BeamRoot Spring(double k_nm_per_rad) { return {k_nm_per_rad}; }
  bool clamped() const { return stiffness_nm_per_rad > std::numeric_limits<double>::max(); }
};

/// One bending mode psi(x) of an Euler-Bernoulli beam of uniform sections, clamped by default.
///
/// In every section EI psi'''' = w^2 rho A psi with the section's own beta = (w^2 rho A/EI)^(1/4);
/// psi, psi', EI psi'' and EI psi''' are continuous; at the tip EI psi'' = w^2 J_t psi' and
/// EI psi''' = -w^2 m_t psi. Scaled so that psi(L) = 1: phi is then the mode's tip deflection in
/// metres. Not modelled: shear, rotary inertia of the section, axial force, damping.
/// Symbol: psi_ij for mode j of link i (model/symbols.md).
/// Frame: x along the undeformed link, 0 at the clamp; deflection along +y of the link frame.
/// Source: thesis (3.1)-(3.7) corrected by docs/theory/errata.md 2: one beta per section instead
/// of (3.7)'s single one.
/// Real-time: start-up only (searches the section, uses libm).
class BeamMode {
 public:
  /// The shape in one section: four coefficients in a well-conditioned basis.
  struct Piece {
    double start_m;  ///< x of its root end
    double length_m;
    double beta_per_m;
    bool decaying;  ///< basis cos, sin, exp(-bx), exp(-b(l-x)); otherwise Krylov's functions
    std::array<double, 4> c;
  };

  BeamMode(double frequency_rad_s, std::vector<Piece> piece);

  double frequency_rad_s() const { return frequency_rad_s_; }
  double length_m() const { return length_m_; }
  /// beta of the first section times the whole length; the usual beta*L of a uniform beam.
  double beta_length() const { return piece_.front().beta_per_m * length_m_; }
  const std::vector<Piece>& piece() const { return piece_; }

  // 0 <= x_m <= L; at a step the value of the outboard section (curvature jumps there).
  double Value(double x_m) const { return Derivative(x_m, 0); }      ///< psi, 1
  double Slope(double x_m) const { return Derivative(x_m, 1); }      ///< psi', 1/m
  double Curvature(double x_m) const { return Derivative(x_m, 2); }  ///< psi'', 1/m^2
  double Third(double x_m) const { return Derivative(x_m, 3); }      ///< psi''', 1/m^3

 private:
  double Derivative(double x_m, int order) const;

  double frequency_rad_s_;
  double length_m_;
  std::vector<Piece> piece_;
};

/// Number of natural frequencies of the beam that lie below `frequency_rad_s`; a pinned beam's
/// rigid-body root, 0, is one of them.
///
/// Wittrick and Williams, Q. J. Mech. Appl. Math. 24 (1971) 263: clamped-clamped frequencies of the
/// sections plus negative eigenvalues of the exact dynamic stiffness. Exact for any w, so a search
/// based on it misses no root, however close two of them are.
int CountFrequenciesBelow(const std::vector<BeamSection>& section, const BeamTip& tip,
                          double frequency_rad_s, BeamRoot root = BeamRoot::Clamped());

/// Frequency `order` of the pinned beam, rad/s; 0 for order 1, the rigid-body root.
double PinnedFrequency(const std::vector<BeamSection>& section, const BeamTip& tip, int order);

/// The lowest `count` elastic modes, ascending: a pinned beam's rigid-body mode is left out.
/// Frequencies are good to a few units of round-off (uniform beams: beta*L within 1e-12 of the
/// closed form).
/// @param name  of the beam in messages, for example "link 1"
/// @throws std::invalid_argument if there is no section, a property is not positive, a tip property
/// or the root's stiffness is negative, or count < 1; RootSearchError if a frequency is not found.
std::vector<BeamMode> NaturalModes(const std::vector<BeamSection>& section, const BeamTip& tip,
                                   BeamRoot root, int count, const std::string& name = "beam");

/// NaturalModes of the clamped beam.
std::vector<BeamMode> ClampedModes(const std::vector<BeamSection>& section, const BeamTip& tip,
                                   int count, const std::string& name = "beam");

/// Checks the requirements of NaturalModes. @throws std::invalid_argument if one is violated.
void CheckBeam(const std::vector<BeamSection>& section, const BeamTip& tip, BeamRoot root,
               int count, const std::string& name);

}  // namespace flexarm
