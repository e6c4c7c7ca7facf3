#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "tests/support/thesis_rig.h"
#include "tools/analysis/parametric_study.h"
#include "tools/analysis/spectrum.h"
#include "tools/analysis/statement.h"
#include "tools/thesis/parametric_statements.h"

namespace flexarm {
namespace {

std::vector<double> Sinusoid(double amplitude, double hz, double offset) {
  std::vector<double> values;
  for (int k = 0; k < 4096; ++k) {
    values.push_back(offset + amplitude * std::sin(2.0 * M_PI * hz * 2e-3 * k + 0.4));
  }
  return values;
}

// Lines lie 0.1221 Hz apart. On a line the amplitude is exact; halfway between two lines a Hann
// window loses 15 %. The frequency is correct in both cases, up to the leakage of the mirror image
// below 0 Hz.
TEST(AmplitudeSpectrum, SinusoidShowsItsAmplitudeAndFrequency) {
  const double line_hz = 1.0 / (4096 * 2e-3);
  for (const double lines : {40.0, 40.25, 40.5, 100.7}) {
    const Spectrum spectrum = AmplitudeSpectrum(Sinusoid(3.0, lines * line_hz, 7.0), 2e-3);
    EXPECT_NEAR(spectrum.step_hz, line_hz, 1e-15);
    EXPECT_NEAR(DominantFrequencyHz(spectrum, 0.3), lines * line_hz, 1e-4);
    const double seen = spectrum.amplitude[spectrum.Largest(0.3)];
    EXPECT_LT(seen, 3.0 * (1.0 + 1e-4));
    EXPECT_GT(seen, 3.0 * 0.848);
    if (lines == 40.0) {
      EXPECT_NEAR(seen, 3.0, 1e-10);
    }
  }
}

TEST(AmplitudeSpectrum, MeanIsRemovedAndBadInputIsRefused) {
  const Spectrum spectrum = AmplitudeSpectrum(std::vector<double>(64, 5.0), 0.1);
  for (const double amplitude : spectrum.amplitude) EXPECT_NEAR(amplitude, 0.0, 1e-14);
  EXPECT_THROW(AmplitudeSpectrum(std::vector<double>(7), 0.1), std::invalid_argument);
  EXPECT_THROW(AmplitudeSpectrum(std::vector<double>(64), 0.0), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(spectrum.Largest(100.0)), std::invalid_argument);
}

TEST(Figure, HasTheRequestedDigits) {
  EXPECT_EQ(Figure(8.7584), "8.76");
  EXPECT_EQ(Figure(0.02345, 2), "0.023");
  EXPECT_EQ(Figure(-123.4, 2), "-123");
  EXPECT_EQ(Figure(0.0, 2), "0.0");
  EXPECT_EQ(Figure(1.234e-7), "1.23e-07");
  EXPECT_EQ(Figure(std::nan("")), "no finite number");
}

TEST(Counted, ListsEveryVerdict) {
  const Statement holds{"3.4", "a", "1", Verdict::kHolds};
  const Statement not_tested{"3.4", "b", "2", Verdict::kNotTested};
  EXPECT_EQ(Counted({holds, not_tested, holds}),
            "holds: 2, holds in part: 0, depends on the excitation: 0, does not hold: 0, "
            "not testable: 1");
}

TEST(StatementTable, EscapesCharactersThatWouldEndACell) {
  const std::string table = StatementTable({{"3.4", "a|b", "1", Verdict::kDoesNot}});
  EXPECT_NE(table.find("| 3.4 | a\\|b | 1 | does not hold |"), std::string::npos);
}

RigConfig ThesisConfig() {
  RigConfig config{};
  config.arm = ThesisRig();
  config.sim.plant_modes = 2;
  config.sim.step_ms = 0.5;
  config.controller.payload_range_kg = {0.0, 1.0};
  return config;
}

const ParametricStudy& WeakStudy() {
  static const ParametricStudy kStudy = RunParametricStudy(ThesisConfig(), {});
  return kStudy;
}

// The nominal value of every parameter describes the same arm: seven sweeps have one run in common.
TEST(ParametricStudy, SweepsMeetAtTheNominalArm) {
  const ParametricStudy& study = WeakStudy();
  ASSERT_EQ(study.sweep.size(), std::size_t{kSweeps});
  double peak = 0.0;
  for (const ParametricSweep& sweep : study.sweep) {
    bool met = false;
    for (const ParametricPoint& point : sweep.point) {
      if (std::abs(point.value - sweep.nominal) > 1e-9) continue;
      met = true;
      if (peak == 0.0) peak = point.signal[kBending1].peak;
      EXPECT_NEAR(point.signal[kBending1].peak / peak, 1.0, 1e-9) << sweep.name;
    }
    EXPECT_TRUE(met) << sweep.name << " does not include its nominal value";
  }
}

// A spring that carries a torque twists by torque / K. Joint 1 sticks and joint 2 has no torque:
// rotor 1 oscillates about that value, and nothing else moves.
TEST(ParametricStudy, StuckJointTwistsByTorqueOverStiffness) {
  RigConfig config = ThesisConfig();
  config.arm.joint[0].coulomb_friction_nm = config.arm.joint[1].coulomb_friction_nm = 10.0;
  const ParametricStudy study = RunParametricStudy(config, {.torque_nm = {0.4, 0.0}});
  const ParametricSweep& sweep = study.At(kStiffness1);
  for (const ParametricPoint& point : sweep.point) {
    // A step on an undamped spring reaches twice the static value; reversed at any phase, at most
    // four times that value.
    const double static_mrad = 1e3 * 0.4 / point.value;
    EXPECT_GE(point.signal[kTwist1].peak, 1.99 * static_mrad);
    EXPECT_LE(point.signal[kTwist1].peak, 4.01 * static_mrad);
    EXPECT_NEAR(point.signal[kBending1].peak, 0.0, 1e-6) << "a sticking joint moves no link";
  }
}

const Statement& About(const std::vector<Statement>& statements, const std::string& words) {
  for (const Statement& s : statements) {
    if (s.thesis.find(words) != std::string::npos) return s;
  }
  throw std::out_of_range(words);
}

// docs/theory/plant.md 9 on chapter 5: which statements a correct model confirms, and which not.
TEST(ParametricStatements, AgreeWithTheReferenceList) {
  const std::vector<Statement> s = ParametricStatements(WeakStudy(), WeakStudy());
  for (const char* words : {"payload lowers", "oscillates dramatically less",
                            "friction lowers the bending", "lower frequencies and vibrates more"}) {
    EXPECT_EQ(About(s, words).verdict, Verdict::kHolds) << words;
  }
  for (const char* words : {"the more the larger the payload", "stiffer joint lowers the freq",
                            "friction raises", "length of 0.6 m"}) {
    EXPECT_EQ(About(s, words).verdict, Verdict::kDoesNot) << words;
  }
  EXPECT_NE(About(s, "above 2 deg").verdict, Verdict::kHolds);
  EXPECT_NE(About(s, "payload lowers").model.find("7.92 -> 5.94 Hz"), std::string::npos);
}

}  // namespace
}  // namespace flexarm
