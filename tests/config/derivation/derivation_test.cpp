#include "config/derivation/derivation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>

#include "config/config.h"
#include "model/problem_list.h"
#include "tests/config/config_testing.h"

namespace flexarm {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TuningBasis BasisOf(const RigConfig& config) {
  return {.arm = config.arm,
          .sensors = config.sensors,
          .period_s = config.loop.period_s(),
          .torque_limit_nm = config.safety.torque_limit_nm,
          .strain_limit = {kNaN, kNaN},
          .payload_range_kg = config.controller.payload_range_kg};
}

TuningBasis ThesisBasis() { return BasisOf(LoadConfig(Shipped("thesis-rig.toml"))); }

std::map<std::string, DerivedValue> ByKey(const TuningBasis& basis) {
  std::map<std::string, DerivedValue> by_key;
  for (DerivedValue& value : DeriveTuning(basis)) by_key[value.key] = value;
  return by_key;
}

// Closed forms for a uniform link: M = strain EI / (h/2), with the numbers of Table 2.
TEST(ArmScales, AreThoseOfTheThesisArm) {
  const ArmScales scales = ScalesOf(ThesisBasis());
  // 0.95 of 2047 counts of 20 V / 4096 at 5000 V.
  const double strain = 0.95 * 2047.0 * (20.0 / 4096.0) / 5000.0;
  EXPECT_DOUBLE_EQ(scales.strain_limit[0], strain);
  EXPECT_NEAR(scales.torque_nm[0], strain * 6.89e10 * 2.657e-10 / 2.25e-3, 1e-9);
  EXPECT_EQ(scales.torque_nm[1], 6.0) << "the drive is weaker than the link";
  // A link with a heavy end bends like a cantilever with a force there: d = strain L^2 / (3 h/2).
  EXPECT_NEAR(scales.deflection_m[0], strain * 0.8 * 0.8 / (3.0 * 2.25e-3), 0.01);
  EXPECT_NEAR(scales.torsion_rad[1], 6.0 / 497.96, 1e-9);
}

TEST(ArmScales, LinkOneBearsTheReactionOfTheElbow) {
  TuningBasis basis = ThesisBasis();
  basis.torque_limit_nm = {30.0, 100.0};
  basis.arm.link[1].section[0].second_moment_m4 *= 100.0;
  const ArmScales scales = ScalesOf(basis);
  EXPECT_EQ(scales.torque_nm[1], scales.torque_nm[0]);
}

struct Factor {
  const char* key;
  double most;  // the larger of derived / shipped and its inverse, over all elements
};

// The factors that docs/theory/derivation.md states.
class ThesisRig : public testing::TestWithParam<Factor> {};

TEST_P(ThesisRig, HasTheShippedValueWithinTheStatedFactor) {
  const auto [key, most] = GetParam();
  const std::string text = LoadConfig(Shipped("thesis-rig.toml")).text;
  const RigConfig config = ParseConfig(text, "thesis-rig");
  const DerivedValue derived = ByKey(ThesisBasis()).at(key);
  double worst = 1.0;
  for (std::size_t i = 0; i < derived.value.size(); ++i) {
    const std::string element = derived.is_list ? ProblemList::Element(key, i) : key;
    const double shipped = NumberAt(config, element).value();
    if (shipped == 0.0) {
      EXPECT_EQ(derived.value[i], 0.0) << element;
      continue;
    }
    worst = std::max({worst, derived.value[i] / shipped, shipped / derived.value[i]});
  }
  EXPECT_LE(worst, most) << "derived: " << testing::PrintToString(derived.value);
  EXPECT_GE(worst, 0.6 * most) << "the stated factor is too wide";
}

INSTANTIATE_TEST_SUITE_P(
    Key, ThesisRig,
    testing::Values(
        Factor{"sim.step_ms", 1.0}, Factor{"loop.acquire_before_ms", 1.0},
        Factor{"loop.step_deadline_ms", 1.0}, Factor{"estimator.modes_per_link", 1.0},
        Factor{"estimator.process_force", 13.0}, Factor{"estimator.rotor_extra_sigma_rad", 1.4},
        Factor{"estimator.modal_sigma_m", 5.0}, Factor{"estimator.max_joint_rate_rad_s", 1.1},
        Factor{"estimator.hub_rotor_limit_rad", 1.1}, Factor{"estimator.strain_family_limit", 1.1},
        Factor{"estimator.strain_stuck_limit", 1.1}, Factor{"estimator.payload.process_force", 4.0},
        Factor{"estimator.payload.start_kg", 1.0}, Factor{"estimator.payload.max_kg", 1.0},
        Factor{"estimator.payload.walk_kg", 1.1}, Factor{"estimator.payload.friction_max_nm", 1.1},
        Factor{"controller.alpha", 2.0}, Factor{"controller.hub_angle_weight", 12.0},
        Factor{"controller.torque_weight", 1.0}, Factor{"controller.adaptation_gain", 1.1},
        Factor{"controller.pd_stiffness_nm_per_rad", 1.1},
        Factor{"controller.pd_damping_nms_per_rad", 1.1},
        Factor{"controller.payload.reference_kg", 1.0},
        Factor{"controller.payload.fast_fraction", 1.0},
        Factor{"controller.payload.fast_least_s", 1.1},
        Factor{"controller.payload.gain_payload_kg", 1.0},
        Factor{"limits.slew_limit_nm_per_s", 1.25}, Factor{"limits.hub_rate_rad_s", 1.4},
        Factor{"limits.strain_limit", 1.0}, Factor{"safety.stop_timeout_s", 1.0},
        Factor{"safety.rest_strain_rate_per_s", 1.1}, Factor{"commissioning.pluck_torque_nm", 1.3}),
    [](const auto& test) {
      std::string name = test.param.key;
      std::replace_if(name.begin(), name.end(), [](char c) { return c == '.'; }, '_');
      return name;
    });

// The scales carry all units: an arm of other size and strength has the same values in them.
TEST(Derivation, FollowsTheTorqueOfTheArm) {
  TuningBasis weak = ThesisBasis(), strong = ThesisBasis();
  weak.torque_limit_nm = {3.0, 0.6};
  strong.torque_limit_nm = {6.0, 1.2};
  for (const char* key : {"estimator.process_force", "estimator.payload.process_force",
                          "controller.pd_stiffness_nm_per_rad", "limits.slew_limit_nm_per_s"}) {
    const std::vector<double> one = ByKey(weak).at(key).value, two = ByKey(strong).at(key).value;
    for (std::size_t i = 0; i < one.size(); ++i) {
      EXPECT_NEAR(two[i], 2.0 * one[i], 0.01 * two[i]) << key << " " << i;
    }
  }
}

// 8 sqrt(J / S): less torque, a longer stop; none is longer than 10 s.
TEST(Derivation, AWeakArmHasLongerToStop) {
  TuningBasis basis = ThesisBasis();
  const ArmScales scales = ScalesOf(basis);
  basis.torque_limit_nm = {scales.torque_nm[0], 0.15};
  const double inertia_kgm2 = ScalesOf(basis).inertia_kgm2[1];
  const auto stop_s = [&basis] { return ByKey(basis).at("safety.stop_timeout_s").value[0]; };
  EXPECT_NEAR(stop_s(), 8.0 * std::sqrt(inertia_kgm2 / 0.15), 5e-3) << "three digits";
  basis.torque_limit_nm[1] = 0.001;
  EXPECT_EQ(stop_s(), 10.0);
}

TEST(Derivation, KeepsTheRatesWithinWhatTheCountersCanTell) {
  TuningBasis basis = ThesisBasis();
  for (EncoderConfig& encoder : basis.sensors.encoder) encoder.counter_bits = 6;
  const auto by_key = ByKey(basis);
  const double half_range = 32.0 * 2.0 * M_PI / 2540.0 / 0.02;
  const double jump = by_key.at("estimator.max_joint_rate_rad_s").value[0];
  EXPECT_LT(jump, half_range);
  for (const double limit : by_key.at("limits.hub_rate_rad_s").value) EXPECT_LT(limit, jump);
}

TEST(Derivation, HasOneModeWhereALinkHasOneGauge) {
  TuningBasis basis = ThesisBasis();
  std::erase_if(basis.sensors.strain, [](const StrainChannelConfig& gauge) {
    return gauge.link == 2 && gauge.position_m > 0.1;
  });
  EXPECT_EQ(ByKey(basis).at("estimator.modes_per_link").value, std::vector<double>{1.0});
}

}  // namespace
}  // namespace flexarm
