#include "hal/gauge_filter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace flexarm {
namespace {

constexpr double kHz = 2.0, kStep_s = 0.01;
constexpr double kW = 2.0 * std::numbers::pi * kHz;

GaugeFilter Filter(double damping) {
  return {{.converter_bits = 16,
           .range_v = 10.0,
           .filter_hz = kHz,
           .noise_counts = 0.0,
           .filter_damping = damping},
          kStep_s,
          1};
}

GaugeFilter::Signals One(double value) { return GaugeFilter::Signals::Constant(1, value); }

// Textbook step response of w^2 / (s^2 + 2 zeta w s + w^2) at t = 0.
double StepAnswer(double zeta, double t) {
  if (t <= 0.0) return 0.0;
  if (zeta == 1.0) return 1.0 - (1.0 + kW * t) * std::exp(-kW * t);
  if (zeta < 1.0) {
    const double wd = kW * std::sqrt(1.0 - zeta * zeta);
    return 1.0 - std::exp(-zeta * kW * t) * (std::cos(wd * t) + zeta * kW / wd * std::sin(wd * t));
  }
  const double root = std::sqrt(zeta * zeta - 1.0);
  const double slow = kW * (zeta - root), fast = kW * (zeta + root);
  return 1.0 - (fast * std::exp(-slow * t) - slow * std::exp(-fast * t)) / (fast - slow);
}

// The filter uses the mean of the input's step in the first step: half a step at t = 0 and half one
// step later, exactly. Round-off of 200 steps: 1e-12.
TEST(GaugeFilter, SecondOrderStepResponseAgreesWithTheTextbook) {
  for (const double zeta : {0.3, 0.9, 1.0, 1.6}) {
    GaugeFilter filter = Filter(zeta);
    for (int k = 1; k <= 200; ++k) {
      filter.Step(One(1.0));
      const double t = k * kStep_s;
      const double expected = 0.5 * (StepAnswer(zeta, t) + StepAnswer(zeta, t - kStep_s));
      EXPECT_NEAR(filter.output()(0), expected, 1e-12) << "zeta " << zeta << ", t " << t;
    }
  }
}

TEST(GaugeFilter, ASettledFilterStaysConstant) {
  for (const double zeta : {0.0, 0.9}) {
    GaugeFilter filter = Filter(zeta);
    filter.Settle(One(0.7));
    for (int k = 0; k < 10; ++k) filter.Step(One(0.7));
    EXPECT_NEAR(filter.output()(0), 0.7, 1e-15);
  }
}

TEST(GaugeFilter, WithoutACornerPassesItsInput) {
  GaugeFilter filter({.converter_bits = 16,
                      .range_v = 10.0,
                      .filter_hz = 0.0,
                      .noise_counts = 0.0,
                      .filter_damping = 0.9},
                     kStep_s, 1);
  filter.Step(One(-0.4));
  EXPECT_EQ(filter.output()(0), -0.4);
}

}  // namespace
}  // namespace flexarm
