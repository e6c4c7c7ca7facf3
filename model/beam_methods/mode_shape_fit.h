#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "model/beam/beam_modes.h"

namespace flexarm {

/// A mode shape fitted to samples.
struct ModeShapeFit {
  BeamMode mode;        ///< a shape per section, continuity not enforced
  double rms_residual;  ///< of the samples, in their unit
  double max_residual;

  /// C_1..C_4 of (3.7) in one section: sin, sinh, cos, cosh of beta (x - the section's root end).
  std::array<double, 4> Coefficients(std::size_t section) const;
};

/// Least-squares fit of (3.7) to samples w(x) of a mode of known frequency, each section separately
/// with its own beta = (omega^2 rho A/(EI))^(1/4).
///
/// The thesis fits one beta to the whole link, which is right for a uniform link only. Samples at a
/// step belong to both sections. Solved in the basis of beam_basis.h, which loses no digits where
/// sinh and cosh agree; Coefficients() has the thesis's form.
/// and cosh agree; Coefficients() has the thesis's form.
/// @param x_m, w  samples, ascending from 0 to L
/// @throws std::invalid_argument if a section has fewer than four samples or the sizes differ.
ModeShapeFit FitModeShape(const std::vector<BeamSection>& section, double frequency_rad_s,
                          const std::vector<double>& x_m, const std::vector<double>& w);

}  // namespace flexarm
