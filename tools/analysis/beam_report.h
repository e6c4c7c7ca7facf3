#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "model/beam/beam_modes.h"
#include "tools/plot/gnuplot.h"

namespace flexarm {

/// One link as a single beam, with a given boundary condition at its root.
struct LinkBeam {
  int link;  ///< 1 or 2
  std::vector<BeamSection> section;
  BeamTip tip;
  BeamRoot root;
  std::string base;  ///< "clamped", "pinned" or "spring"
};

/// {"link", "base", "beta_l", "frequency_hz"}; beta_l by the first section's beta.
nlohmann::ordered_json BeamJson(const LinkBeam& beam, const std::vector<BeamMode>& modes);

/// Error of the frequencies of the lumped transfer matrix against the exact ones, over the number
/// of parts per section N, and the fit of (3.7) to the shapes of the largest N: {"link", "parts",
/// "error_percent" (one row per N), "fit_parts", "fit_rms_residual", "fit_coefficients" (mode,
/// section, C_1..C_4)}.
nlohmann::ordered_json ConvergenceJson(const LinkBeam& beam, const std::vector<BeamMode>& modes);

/// Draws the mode shapes of the links, each scaled to a largest value of 1, and if asked the
/// convergence of the lumped beam. @throws std::runtime_error if gnuplot fails
void DrawBeams(const std::vector<LinkBeam>& beams, const std::vector<std::vector<BeamMode>>& modes,
               bool convergence, const std::filesystem::path& output,
               const OutputRules& rules = ReplacedPicture());

}  // namespace flexarm
