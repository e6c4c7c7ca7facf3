#include <algorithm>
#include <cmath>

#include "model/beam_methods/lumped_beam.h"
#include "model/beam_methods/mode_shape_fit.h"
#include "tools/thesis/thesis_check.h"

namespace flexarm {
namespace {

constexpr BeamTip kBare{0.0, 0.0};
constexpr double kClaimed_percent = 0.05;  // 3.2
constexpr int kFirstModes = 4;

// A uniform beam like link 2, the thesis's case with analytic solutions.
std::vector<BeamSection> Uniform(const ArmParameters& arm) {
  BeamSection section = arm.link[1].section.front();
  section.length_m = arm.link[1].length_m();
  return {section};
}

class LumpedErrors {
 public:
  LumpedErrors(const ArmParameters& arm, BeamRoot root)
      : section_(Uniform(arm)),
        root_(root),
        exact_(NaturalModes(section_, kBare, root, kFirstModes, "link 2")) {}

  double Percent(int parts, std::size_t mode, LumpInertia inertia = LumpInertia::kNone) const {
    const LumpedBeam beam(section_, kBare, root_, parts, "link 2", inertia);
    const auto lumped = beam.Modes(static_cast<int>(mode) + 1);
    return 100.0 * (lumped[mode].frequency_rad_s / exact_[mode].frequency_rad_s() - 1.0);
  }

  // The smallest number of parts that satisfies the claim. The error falls with its square.
  int PartsFor(std::size_t mode) const {
    const auto enough = [&](int parts) {
      return std::abs(Percent(parts, mode)) < kClaimed_percent;
    };
    int low = kFirstModes, high = 2 * kFirstModes;
    for (; !enough(high); high *= 2) low = high;
    while (high - low > 1) {
      const int middle = (low + high) / 2;
      (enough(middle) ? high : low) = middle;
    }
    return high;
  }

 private:
  std::vector<BeamSection> section_;
  BeamRoot root_;
  std::vector<BeamMode> exact_;
};

Statement LumpedBeamError(const ArmParameters& arm) {
  constexpr int kFew = 10;
  std::string text = "a uniform link in " + std::to_string(kFew) +
                     " parts, clamped: the frequencies of modes 1 to " +
                     std::to_string(kFirstModes) + " are off by";
  const LumpedErrors clamped(arm, BeamRoot::Clamped()), pinned(arm, BeamRoot::Pinned());
  double worst = 0.0;
  for (std::size_t i = 0; i < kFirstModes; ++i) {
    const double percent = clamped.Percent(kFew, i);
    worst = std::max(worst, std::abs(percent));
    text += (i > 0 ? ", " : " ") + Figure(percent);
  }
  const auto needed = [](const LumpedErrors& errors) {
    return std::to_string(errors.PartsFor(0)) + " parts for the first mode, " +
           std::to_string(errors.PartsFor(kFirstModes - 1)) + " for " + std::to_string(kFirstModes);
  };
  text += " %. The claim needs " + needed(clamped) + "; if pinned, " + needed(pinned);
  return {"3.2",
          "the transfer matrix is within " + Figure(kClaimed_percent, 1) +
              " % of the exact frequencies (the number of parts is not stated)",
          text, worst < kClaimed_percent ? Verdict::kHolds : Verdict::kInPart};
}

Statement LumpInertias(const ArmParameters& arm) {
  constexpr int kParts = 20;
  const LumpedErrors clamped(arm, BeamRoot::Clamped());
  const double without = clamped.Percent(kParts, kFirstModes - 1);
  const double with = clamped.Percent(kParts, kFirstModes - 1, LumpInertia::kSlab);
  return {"3.2", "each point has a mass and a concentrated moment of inertia",
          "with a slab's moment of inertia, mode " + std::to_string(kFirstModes) +
              " of a uniform link in " + std::to_string(kParts) + " parts is off by " +
              Figure(with) + " %, with none by " + Figure(without) + " %",
          std::abs(with) < std::abs(without) ? Verdict::kHolds : Verdict::kDoesNot};
}

// Rms residual of (3.7) fitted to a lumped shape of a link, in percent of its tip deflection, with
// the beta of each section or with that of the last one for the whole link.
double FitResidual_percent(const std::vector<BeamSection>& section, bool single_beta) {
  constexpr int kParts = 100, kOrder = 2;
  const LumpedMode shape =
      LumpedBeam(section, kBare, BeamRoot::Clamped(), kParts).Modes(kOrder).back();
  std::vector<BeamSection> fitted = section;
  if (single_beta) {
    fitted = {section.back()};
    fitted.front().length_m = shape.x_m.back();
  }
  return 100.0 * FitModeShape(fitted, shape.frequency_rad_s, shape.x_m, shape.w).rms_residual;
}

// Below this limit a residual is round-off, or negligible.
std::string Residual(double percent) {
  constexpr double kShown_percent = 0.001;
  return percent < kShown_percent ? "less than " + Figure(kShown_percent, 1) + " %"
                                  : Figure(percent, 2) + " %";
}

Statement SingleBeta(const ArmParameters& arm) {
  const std::vector<BeamSection> uniform = Uniform(arm);
  BeamSection root = uniform.front(), rest = root;
  root.length_m *= 0.1;
  rest.length_m *= 0.9;
  root.area_m2 *= 2.0;
  root.second_moment_m4 *= 8.0;
  const double plain = FitResidual_percent(uniform, true);
  const double single = FitResidual_percent({root, rest}, true);
  const double each = FitResidual_percent({root, rest}, false);
  return {"3.2", "(3.7) with one beta fits the shapes of arms with steps in their cross section",
          "rms residual of mode 2, of the tip's deflection: a uniform link " + Residual(plain) +
              "; with the first tenth twice as thick " + Residual(single) +
              ", and with a beta for each section " + Residual(each),
          single < 0.1 ? Verdict::kHolds : Verdict::kDoesNot};
}

}  // namespace

std::vector<Statement> BeamStatements(const ArmParameters& arm) {
  return {LumpedBeamError(arm), LumpInertias(arm), SingleBeta(arm)};
}

}  // namespace flexarm
