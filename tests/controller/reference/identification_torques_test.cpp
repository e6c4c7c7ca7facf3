// Chirp and PRBS against signal theory, and through the reference model.

#include "controller/reference/identification_torques.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

#include "controller/reference/reference.h"
#include "controller/types/rejected_error.h"
#include "tests/controller/law/shipped_rig.h"
#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

using testing::HasSubstr;

// Golomb: N values +-1 with N = 2^n - 1, one more 1 than -1, and an autocorrelation of -1
// at every shift. Only a primitive polynomial gives that.
TEST(MaximalLengthSequence, IsBalancedAndUncorrelatedAtEveryShift) {
  for (int bits = 2; bits <= 12; ++bits) {
    const std::vector<int> sequence = MaximalLengthSequence(bits, 1);
    const std::size_t n = sequence.size();
    ASSERT_EQ(n, (std::size_t{1} << bits) - 1);
    EXPECT_EQ(std::accumulate(sequence.begin(), sequence.end(), 0), 1) << bits;
    for (std::size_t shift = 1; shift < n; shift += bits < 9 ? 1 : 37) {
      int sum = 0;
      for (std::size_t i = 0; i < n; ++i) sum += sequence[i] * sequence[(i + shift) % n];
      ASSERT_EQ(sum, -1) << bits << " bits, shift " << shift;
    }
  }
}

TEST(MaximalLengthSequence, AnotherSeedIsTheSameSequenceShifted) {
  const std::vector<int> one = MaximalLengthSequence(6, 1), other = MaximalLengthSequence(6, 37);
  EXPECT_NE(one, other);
  std::vector<int> shifted = one;
  bool found = false;
  for (std::size_t i = 0; i < one.size() && !found; ++i) {
    std::rotate(shifted.begin(), shifted.begin() + 1, shifted.end());
    found = shifted == other;
  }
  EXPECT_TRUE(found);
}

double PowerAt(const std::vector<double>& signal, double hz) {
  std::complex<double> sum = 0.0;
  for (std::size_t k = 0; k < signal.size(); ++k) {
    sum += signal[k] *
           std::polar(1.0, -2.0 * std::numbers::pi * hz * kPeriod_s * static_cast<double>(k));
  }
  return std::norm(sum);
}

// The spectrum of the sequence is flat but at 0, so at the lines i / duration that of the torques
// is the pulse's: |sum of four holds|^2 (N + 1), exactly.
TEST(Prbs, TheSpectrumIsThatOfThePulse) {
  const Prbs prbs{.start_s = 0, .hold_s = 0.06, .bits = 6, .seed = 5, .torque_nm = {1, 1}};
  for (const int joint : {0, 1}) {
    const std::vector<double> signs = PrbsSigns(prbs, 3, joint);
    ASSERT_NEAR(static_cast<double>(signs.size()) * kPeriod_s, prbs.duration_s(), 1e-9);
    std::vector<double> pulse = {1, 1, 1, -1, -1, -1, -1, -1, -1, 1, 1, 1};
    for (int line = 1; line < 200; ++line) {
      if (line % 63 == 0) continue;
      const double hz = line / prbs.duration_s();
      const double expected = PowerAt(pulse, hz) * 64.0;
      EXPECT_NEAR(PowerAt(signs, hz), expected, 1e-8 * 144.0 * 64.0) << line;
    }
  }
}

// The band that docs/experiments.md states: half of the peak power between 0.18 and 0.39 over the
// hold time.
TEST(Prbs, TheBandAgreesWithTheDocumentation) {
  const std::vector<double> pulse = [] {
    std::vector<double> p;
    for (const double sign : {1.0, -1.0, -1.0, 1.0}) p.insert(p.end(), 50, sign);  // hold 1 s
    return p;
  }();
  double peak = 0.0;
  for (double hz = 0.01; hz < 1.0; hz += 0.001) peak = std::max(peak, PowerAt(pulse, hz));
  EXPECT_LT(PowerAt(pulse, 0.17), 0.5 * peak);
  EXPECT_GT(PowerAt(pulse, 0.19), 0.5 * peak);
  EXPECT_GT(PowerAt(pulse, 0.38), 0.5 * peak);
  EXPECT_LT(PowerAt(pulse, 0.40), 0.5 * peak);
}

Experiment With(std::vector<Chirp> chirps, std::vector<Prbs> prbs) {
  return {.name = "test",
          .text = "",
          .duration_s = 20.0,
          .doublet = {},
          .sim_event = {},
          .chirp = std::move(chirps),
          .prbs = std::move(prbs)};
}

ReferenceTable ExcitedTable(const Experiment& experiment) {
  return {experiment, ShippedDesign(), kPeriod_s, {0.1, -0.2}, ShippedLimits()};
}

constexpr Chirp kChirp = {
    .start_s = 1.0, .duration_s = 12.0, .from_hz = 0.3, .to_hz = 2.0, .amplitude_deg = {2.0, -3.0}};
constexpr Prbs kPrbs = {
    .start_s = 1.0, .hold_s = 0.06, .bits = 6, .seed = 5, .torque_nm = {3.0, 0.3}};

// The reference model contains a double integrator; its bending has decayed 4 s later. Round-off of
// 1e-16 x 600 samples squared.
TEST(Identification, TheReferenceEndsAtRestWhereItBegan) {
  for (const Experiment& experiment : {With({kChirp}, {}), With({}, {kPrbs})}) {
    const ReferenceTable table = ExcitedTable(experiment);
    const ReferenceSample& end = table.At(table.periods());
    EXPECT_NEAR(end.x_m[0], 0.1, 1e-9);
    EXPECT_NEAR(end.x_m[1], -0.2, 1e-9);
    for (std::size_t i = 2; i < 12; ++i) EXPECT_NEAR(end.x_m[i], 0.0, 1e-8) << i;
    double moved = 0.0;
    for (int k = 0; k <= table.periods(); ++k) {
      moved = std::max(moved, std::fabs(table.At(k).x_m[0] - 0.1));
    }
    EXPECT_GT(moved, 0.01) << "the reference must move";
  }
}

// A sweep spends equal time at all frequencies of its band: over the whole signal the power is
// about constant inside and falls off outside. 0.3 .. 2 Hz in 12 s: constant to a third in the
// middle of the band, below a twentieth half an octave outside.
TEST(Chirp, CoversItsBand) {
  const std::vector<double> y = ChirpAngles(kChirp, 600, kPeriod_s);
  EXPECT_EQ(y.front(), 0.0);
  EXPECT_EQ(y.back(), 0.0);
  const double middle = PowerAt(y, 1.15);
  for (double hz = 0.6; hz < 1.7; hz += 0.1) EXPECT_GT(PowerAt(y, hz), middle / 3.0) << hz;
  EXPECT_LT(PowerAt(y, 0.1), middle / 20.0);
  EXPECT_LT(PowerAt(y, 3.0), middle / 20.0);
}

TEST(Chirp, BeyondAQuarterOfTheSamplingRateIsRefused) {
  Chirp fast = kChirp;
  fast.to_hz = 13.0;
  try {
    ExcitedTable(With({fast}, {}));
    FAIL() << "accepted";
  } catch (const RejectedError& refused) {
    EXPECT_THAT(refused.what(), AllOf(HasSubstr("chirp[0]"), HasSubstr("12.5 Hz")));
  }
}

TEST(Prbs, TorquesHaveTheConfiguredAmplitudes) {
  const ReferenceTable table = ExcitedTable(With({}, {kPrbs}));
  for (int k = 50; k < 50 + 63 * 12; ++k) {
    EXPECT_EQ(std::fabs(table.At(k).u_m_nm[0]), 3.0) << k;
    EXPECT_EQ(std::fabs(table.At(k).u_m_nm[1]), 0.3) << k;
  }
  EXPECT_EQ(table.At(49).u_m_nm[0], 0.0);
  EXPECT_EQ(table.At(50 + 63 * 12).u_m_nm[0], 0.0);
}

}  // namespace
}  // namespace flexarm
