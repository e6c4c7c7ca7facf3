#include "tools/thesis/appendix_statements.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "model/math/dense_decompositions.h"
#include "tools/analysis/gauge_placing.h"
#include "tools/analysis/gauge_verification.h"
#include "tools/thesis/rig_needs.h"

namespace flexarm {
namespace {

constexpr double kFitAsGood = 1.1;  // ratio of errors
constexpr double kAccurate = 0.05;  // rms error over the largest deflection

// Size of the errors of two modes together: the root of the ellipse's area.
double ErrorSize(const GaugeLayout& layout) {
  return std::pow(layout.covariance_m2.determinant(), 0.25);
}

// The middles of equal parts of a link, as many as the thesis has half bridges.
GaugeLayout EqualParts(const RigConfig& config, const GaugeComparison& gauges) {
  const LinkModes modes = gauges.link == 1 ? Link1Modes(config.arm, gauges.task.modes + 1)
                                           : Link2Modes(config.arm, gauges.task.modes + 1);
  const GaugeShapes shapes(config.arm.link[static_cast<std::size_t>(gauges.link) - 1], modes,
                           gauges.task.modes + 1);
  std::vector<double> position;
  for (std::size_t i = 0; i < kThesisHalfBridges; ++i) {
    position.push_back(shapes.length_m() * (static_cast<double>(i) + 0.5) / kThesisHalfBridges);
  }
  return JudgeGauges(shapes, gauges.task.modes, position,
                     std::vector<double>(kThesisHalfBridges, gauges.task.noise_strain));
}

std::string Sigmas(const GaugeLayout& layout) {
  return Figure(1e6 * layout.sigma_m(0)) + " and " + Figure(1e6 * layout.sigma_m(1), 2);
}

Statement Placing(const RigConfig& config) {
  const char* said = "gauges belong where a strain has a local maximum";
  if (const std::string lacks = LacksTwoModes(config); !lacks.empty()) {
    return NotForThisRig("B1", said, lacks);
  }
  constexpr int kBridges = kThesisHalfBridges;
  std::string text;
  bool best = true, better = false;
  for (const GaugeComparison& gauges : CompareGauges(config, {.modes = 2, .per_link = kBridges})) {
    const GaugeLayout equal = EqualParts(config, gauges);
    const double maxima = ErrorSize(gauges.thesis);
    best = best && maxima < kFitAsGood * ErrorSize(gauges.proposed);
    better = better || maxima < ErrorSize(equal);
    text += (text.empty() ? "standard deviations of modes 1 and 2, um, five gauges with " +
                                Figure(1e6 * gauges.task.noise_strain) + " microstrain of noise, "
                          : "; ") +
            std::string("link ") + std::to_string(gauges.link) + ": at local maxima " +
            Sigmas(gauges.thesis) + ", in equal parts " + Sigmas(equal) +
            ", where they know the modes best " + Sigmas(gauges.proposed) +
            "; there a mm of mode 3 adds " + Figure(std::abs(gauges.proposed.next_mode[0])) +
            " mm to mode 1, at local maxima " + Figure(std::abs(gauges.thesis.next_mode[0]));
  }
  return {"B1", said, text, best ? Verdict::kHolds : better ? Verdict::kInPart : Verdict::kDoesNot};
}

std::string Errors(const std::array<GaugeVerification::Error, 2>& error) {
  return Figure(error[0].rms_mm, 2) + " and " + Figure(error[1].rms_mm, 2);
}

Statement Accurate(const RigConfig& config) {
  const GaugeVerification open = VerifyGauges(config, false), behind = VerifyGauges(config, true);
  bool accurate = true, in_part = true;
  for (std::size_t i = 0; i < 2; ++i) {
    in_part = in_part && open.polynomial[i].rms_mm < kAccurate * open.largest_mm[i];
    accurate = accurate && behind.polynomial[i].rms_mm < kAccurate * behind.largest_mm[i];
  }
  return {"B1", "the gauges measure the deflection very accurately (figure B.2)",
          "the square wave of chapter 4 bends the links by up to " + Figure(open.largest_mm[0]) +
              " and " + Figure(open.largest_mm[1]) +
              " mm; rms error of the polynomial (B.1) from five half bridges " +
              Errors(open.polynomial) + " mm, of a fit of modes to the config's gauges " +
              Errors(open.modal) + " mm; behind the " +
              Figure(config.sensors.strain_input.filter_hz, 2) + " Hz filter, which lags, " +
              Errors(behind.polynomial) + " and " + Errors(behind.modal) + " mm",
          accurate  ? Verdict::kHolds
          : in_part ? Verdict::kInPart
                    : Verdict::kDoesNot};
}

}  // namespace

std::vector<Statement> AppendixStatements(const RigConfig& config) {
  return {Placing(config), Accurate(config)};
}

}  // namespace flexarm
