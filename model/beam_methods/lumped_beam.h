#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "model/beam/beam_modes.h"

namespace flexarm {

/// A mode of the lumped beam: its deflection at the stations, w = 1 at the tip.
struct LumpedMode {
  double frequency_rad_s;
  std::vector<double> x_m;  ///< stations, root to tip
  std::vector<double> w;
};

/// Rotary inertia I_m of a point of the lumped beam.
enum class LumpInertia : std::uint8_t {
  kNone,  ///< zero: consistent with the Euler-Bernoulli beam
  kSlab,  ///< m l^2/12 of a part: the thesis's concentrated moment of inertia; a coarser beam
};

/// Lumped-mass (Myklestad) model of the thesis: point masses on massless elastic parts, by transfer
/// matrices.
///
/// Every section is cut into equal parts; a part's mass is divided equally between its two ends.
/// The field matrix (3.2) transfers the state {-V, M, theta, w} across a part, the point matrix
/// (3.4), with the sign of I_m corrected, across a mass. Independent of the solver of ClampedModes,
/// and so a check of it: its frequencies converge to the exact ones as N^-2. Solutions are made
/// orthonormal at every station, so that long beams lose no digits.
/// Source: thesis 3.2, docs/theory/errata.md 2. Real-time: start-up only.
class LumpedBeam {
 public:
  /// @param parts  N >= 1 per section
  /// @param name   of the beam in messages
  /// @throws std::invalid_argument as NaturalModes.
  LumpedBeam(const std::vector<BeamSection>& section, const BeamTip& tip, BeamRoot root, int parts,
             std::string name = "beam", LumpInertia lump_inertia = LumpInertia::kNone);

  /// Frequencies below `omega_rad_s`: negative pivots of its stiffness less omega^2 mass.
  int CountBelow(double omega_rad_s) const;

  /// Determinant of the far end's two conditions, -V = 0 and M = 0: changes sign at a frequency.
  double EndDeterminant(double omega_rad_s) const;

  /// Elastic modes, ascending; a pinned beam's rigid-body mode is left out.
  /// @throws RootSearchError if the beam has too few masses or EndDeterminant does not change its
  /// sign in the interval found by counting.
  std::vector<LumpedMode> Modes(int count) const;

 private:
  using Solutions = Eigen::Matrix<double, 4, 2>;  // rows -V, M, theta, w in units of EI and length
  struct Station {
    double x_m;
    double mass_kg;
    double inertia_kgm2;
  };
  struct Part {
    double length_m, bending_stiffness_nm2;
  };

  Solutions RootSolutions() const;
  Eigen::Matrix4d PointMatrix(std::size_t station, double omega) const;
  Eigen::Matrix4d FieldMatrix(std::size_t part) const;
  double FindFrequency(int order) const;
  LumpedMode ModeAt(double omega) const;

  std::vector<Station> station_;
  std::vector<Part> part_;
  BeamRoot root_;
  double unit_m_ = 0.0, unit_nm2_ = 0.0;  // length and EI that make the states comparable
  std::string name_;
};

}  // namespace flexarm
