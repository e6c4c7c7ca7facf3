#include "controller/law/adaptive_gain.h"

#include <gtest/gtest.h>

#include "tests/controller/law/shipped_rig.h"

namespace flexarm {
namespace {

// A small gain, computed by hand: n = 2, so 2 x 6.
Eigen::MatrixXd Initial() { return Eigen::MatrixXd::Constant(2, 6, 0.5); }

AdaptiveGain::Regressor Large() { return AdaptiveGain::Regressor::Constant(6, 2.0); }
AdaptiveGain::Regressor Small() { return AdaptiveGain::Regressor::Constant(6, 0.01); }

ControllerConfig GainConfig(double dead_zone_nm, double bound) {
  ControllerConfig config = ShippedRig().controller;
  config.adaptation_gain = 0.1;
  config.sigma = 0.25;
  config.adaptation_dead_zone_nm = dead_zone_nm;
  config.adaptation_bound = bound;
  return config;
}

// 0.1 * 1 * 2 in each of the first row's six entries: |change| = 0.2 sqrt(6).
TEST(AdaptiveGain, AdaptsByTheOuterProduct) {
  AdaptiveGain gain(Initial(), GainConfig(0.0, 100.0));
  gain.Update({1.0, 0.0}, Large());
  EXPECT_NEAR(gain.change(), 0.2 * std::sqrt(6.0), 1e-15);
  EXPECT_NEAR(gain.energy(), 0.04 * 6.0 / 0.1, 1e-13);
  // K_I r: first row 6 * 0.7 * 2, second 6 * 0.5 * 2.
  EXPECT_NEAR(gain.Torque(Large())(0), 8.4, 1e-14);
  EXPECT_NEAR(gain.Torque(Large())(1), 6.0, 1e-14);
}

TEST(AdaptiveGain, InsideTheDeadZoneItOnlyLeaks) {
  AdaptiveGain gain(Initial(), GainConfig(0.1, 100.0));
  gain.Update({1.0, 0.0}, Large());
  const double learnt = gain.change();
  gain.Update({1.0, 0.0}, Small());
  EXPECT_NEAR(gain.change(), 0.75 * learnt, 1e-15);
}

TEST(AdaptiveGain, IsScaledBackToItsBound) {
  AdaptiveGain gain(Initial(), GainConfig(0.0, 0.1));
  gain.Update({1.0, 0.0}, Large());
  EXPECT_NEAR(gain.change(), 0.1, 1e-15);
  EXPECT_NEAR(gain.Torque(Large())(0), 6.0 + 12.0 * 0.1 / std::sqrt(6.0), 1e-14);
  EXPECT_NEAR(gain.Torque(Large())(1), 6.0, 1e-14) << "the other row did not adapt";
}

TEST(AdaptiveGain, ResetRestoresTheInitialGain) {
  AdaptiveGain gain(Initial(), GainConfig(0.0, 100.0));
  gain.Update({1.0, 1.0}, Large());
  gain.Reset();
  EXPECT_EQ(gain.change(), 0.0);
}

}  // namespace
}  // namespace flexarm
