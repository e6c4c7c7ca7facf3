#include "model/beam_methods/mode_shape_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "model/beam_methods/lumped_beam.h"
#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

const BeamTip kTip{0.2, 1e-3};

std::vector<BeamSection> TwoSections() {
  const BeamSection s = ThesisRig().link[1].section[0];
  std::vector<BeamSection> section = {s, s};
  section[0].length_m = 0.3, section[0].second_moment_m4 *= 5.0;
  section[1].length_m = 0.6;
  return section;
}

struct Samples {
  std::vector<double> x, w;
};

Samples ExactSamples(const BeamMode& mode, double noise = 0.0) {
  Samples out;
  for (int i = 0; i <= 60; ++i) {
    const double x = i == 60 ? mode.length_m() : mode.length_m() * i / 60.0;
    out.x.push_back(x);
    out.w.push_back(mode.Value(x) + (i % 2 == 0 ? noise : -noise));
  }
  return out;
}

// (3.7) as printed, from the section's root end.
double Printed(const std::array<double, 4>& C, double z) {
  return C[0] * std::sin(z) + C[1] * std::sinh(z) + C[2] * std::cos(z) + C[3] * std::cosh(z);
}

// An exactly sampled shape is reproduced: residual and shape at round-off (1e-10 of a shape of size
// 1..10), in both bases (mode 1 has beta l < 2 in a section, mode 6 far above).
TEST(ModeShapeFit, ExactShapesAreReproduced) {
  const auto section = TwoSections();
  for (const BeamMode& mode : ClampedModes(section, kTip, 6)) {
    const Samples s = ExactSamples(mode);
    const ModeShapeFit fit = FitModeShape(section, mode.frequency_rad_s(), s.x, s.w);
    EXPECT_LT(fit.rms_residual, 1e-10);
    EXPECT_LT(fit.max_residual, 1e-9);
    for (double x = 0.01; x < 0.9; x += 0.07) {
      EXPECT_NEAR(fit.mode.Value(x), mode.Value(x), 1e-8) << x;
      const std::size_t at = x < 0.3 ? 0 : 1;
      const BeamMode::Piece& piece = mode.piece()[at];
      EXPECT_NEAR(Printed(fit.Coefficients(at), piece.beta_per_m * (x - piece.start_m)),
                  mode.Value(x), 1e-6)
          << x;
    }
  }
}

// Alternating noise of size d, which no smooth shape follows, stays in the residual.
TEST(ModeShapeFit, NoiseStaysInTheResidual) {
  const BeamMode mode = ClampedModes(TwoSections(), kTip, 2).back();
  const Samples s = ExactSamples(mode, 0.01);
  const ModeShapeFit fit = FitModeShape(TwoSections(), mode.frequency_rad_s(), s.x, s.w);
  EXPECT_NEAR(fit.rms_residual, 0.01, 1e-3);
  EXPECT_GE(fit.max_residual, fit.rms_residual);
}

// The thesis's single beta on a stepped link leaves a residual; one beta per section does not.
TEST(ModeShapeFit, SingleBetaDoesNotFitASteppedLink) {
  const BeamMode mode = ClampedModes(TwoSections(), kTip, 3).back();
  const Samples s = ExactSamples(mode);
  BeamSection uniform = TwoSections()[1];
  uniform.length_m = 0.9;
  const ModeShapeFit single = FitModeShape({uniform}, mode.frequency_rad_s(), s.x, s.w);
  const ModeShapeFit each = FitModeShape(TwoSections(), mode.frequency_rad_s(), s.x, s.w);
  EXPECT_GT(single.rms_residual, 1e-2);
  EXPECT_LT(each.rms_residual, 1e-9);
}

// The method of the thesis: shapes of the lumped beam, fitted by (3.7). With N parts the samples
// err by N^-2, and so does the fit.
TEST(ModeShapeFit, LumpedShapesFitToTheirOwnError) {
  const BeamMode exact = ClampedModes(TwoSections(), kTip, 2).back();
  const auto error = [&](int parts) {
    const LumpedMode lumped =
        LumpedBeam(TwoSections(), kTip, BeamRoot::Clamped(), parts).Modes(2).back();
    const ModeShapeFit fit =
        FitModeShape(TwoSections(), lumped.frequency_rad_s, lumped.x_m, lumped.w);
    EXPECT_LT(fit.rms_residual, 1e-2);
    return std::fabs(fit.mode.Value(0.45) - exact.Value(0.45));
  };
  EXPECT_NEAR(error(40) / error(80), 4.0, 0.4);
}

TEST(ModeShapeFit, TooFewSamplesAreRejected) {
  const BeamMode mode = ClampedModes(TwoSections(), kTip, 1).back();
  EXPECT_THROW(FitModeShape(TwoSections(), mode.frequency_rad_s(),
                            {0.0, 0.1, 0.2, 0.5, 0.6, 0.7, 0.9}, {0, 0, 0, 0, 0, 0, 0}),
               std::invalid_argument);
  EXPECT_THROW(FitModeShape(TwoSections(), mode.frequency_rad_s(), {0.0, 0.1}, {0.0}),
               std::invalid_argument);
}

}  // namespace
}  // namespace flexarm
