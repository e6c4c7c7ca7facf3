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

/// What rotary inertia I_m a point of the lumped beam has.
enum class LumpInertia : std::uint8_t {
  kNone,  ///< zero: consistent with the Euler-Bernoulli beam
  kSlab,  ///< m l^2/12 of a part: the thesis's concentrated moment of inertia; a coarser beam
};

/// The thesis's beam of point masses on massless elastic parts, by transfer matrices (Myklestad).
///
/// Every section is cut into equal parts; a part's mass goes by halves to its two ends. The state
/// {-V, M, theta, w} passes a part by the field matrix (3.2) and a mass by the point matrix (3.4)
/// with the sign of I_m mended. A solver apart from ClampedModes', which it checks: its
/// frequencies converge to the exact ones as N^-2. Solutions are made orthonormal at every station,
/// so that long beams keep their digits. Source: thesis 3.2, docs/theory/thesis.md 2.1.
/// Real-time: start-up only.
class LumpedBeam {
 public:
  /// @param parts  N >= 1 a section
  /// @param name   of the beam in messages
  /// @throws std::invalid_argument as NaturalModes.
  LumpedBeam(const std::vector<BeamSection>& section, const BeamTip& tip, BeamRoot root, int parts,
             std::string name = "beam", LumpInertia lump_inertia = LumpInertia::kNone);

  /// Frequencies below `omega_rad_s`: negative pivots of its stiffness less omega^2 mass.
  int CountBelow(double omega_rad_s) const;

  /// The far end's two conditions, -V = 0 and M = 0, as a determinant: changes sign at a frequency.
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
