#include <algorithm>
#include <array>

#include "config/thesis_arm.h"
#include "controller/types/rounded_text.h"
#include "tools/benchmark/benchmark_set.h"
#include "tools/benchmark/disturbance.h"
#include "tools/sweep/better_sensors.h"
#include "tools/sweep/random_moves.h"

namespace flexarm {
namespace {

using Overrides = std::vector<std::string>;

const Overrides kNoFriction = {"joint1.coulomb_friction_nm=0", "joint2.coulomb_friction_nm=0"};
constexpr double kFiner = 10.0;
// The reference keeps 0.05 rad from the soft limit of 90 deg.
constexpr double kFastElbow_deg = 80.0;

Overrides Both(Overrides a, const Overrides& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

Scenario RandomScenario(const RigConfig& config, const MoveRecipe& recipe, const Disturbance& d) {
  Scenario scenario{.name = d.name,
                    .what = d.what,
                    .experiment = {},
                    .payload_kg = 0.0,
                    .variant = d.variant,
                    .plant = d.plant,
                    .config = IsThesisArm(config.arm) ? Both(kWideRig, d.config) : d.config,
                    .tuned_on = false,
                    .random = recipe};
  scenario.experiment.name = "random-moves";
  return scenario;
}

Disturbance FineTheta1(const RigConfig& config) {
  return {.name = "theta1-x10",
          .what = "encoder of theta1 ten times finer",
          .config = FinerEncoders(config.sensors, kFiner, true)};
}

Disturbance FineEncoders(const RigConfig& config) {
  return {.name = "encoders-x10",
          .what = "all encoders ten times finer",
          .config = FinerEncoders(config.sensors, kFiner)};
}

Disturbance NoFriction() {
  return {.name = "no-friction", .what = "no Coulomb friction", .plant = kNoFriction};
}

// A rate of 1 rad/s costs 1/600 and 1/300 of the joints' torques.
Disturbance Viscous(const RigConfig& config) {
  const std::array<double, 2>& limit_nm = config.safety.torque_limit_nm;
  const std::string first = RoundedText(limit_nm[0] / 600.0, 3);
  const std::string second = RoundedText(limit_nm[1] / 300.0, 3);
  return {.name = "viscous",
          .what = "viscous friction of the motors, " + first + " and " + second + " N m s/rad",
          .plant = {"joint1.viscous_friction_nm_s_per_rad=" + first,
                    "joint2.viscous_friction_nm_s_per_rad=" + second}};
}

// Plants of the design study beyond those that are common to all tables.
std::vector<Disturbance> MorePlants(const RigConfig& config) {
  return {
      NoFriction(),
      {.name = "backlash-0.2",
       .what = "0.2 degrees of backlash at the elbow",
       .plant = {"joint2.backlash_rad=0.00349066", "joint2.backlash_model=dead_zone"}},
      {.name = "modal-damping", .what = "modal damping 3 %", .variant = "modal-damping"},
      {.name = "modal-damping-1",
       .what = "modal damping 1 %",
       .plant = {"arm.damping=modal", "link1.damping_ratio=0.01", "link2.damping_ratio=0.01"}},
      Viscous(config),
      {.name = "together",
       .what = "backlash, friction, softness, damping and lost frames at once",
       .variant = "together"},
  };
}

std::string Payloads(const MoveRecipe& recipe) {
  return RoundedText(recipe.payload_kg[0], 3) + " to " + RoundedText(recipe.payload_kg[1], 3) +
         " kg";
}

Scenario FastScenario(const RigConfig& config, const MoveRecipe& recipe, const Disturbance& d) {
  Scenario scenario = RandomScenario(config, recipe, d);
  scenario.config = d.config;  // they keep the soft limits of the rig
  scenario.fast = true;
  return scenario;
}

}  // namespace

std::vector<Scenario> MoveScenarios(const RigConfig& config) {
  const MoveRecipe recipe = RecipeFor(config);
  MoveRecipe light = recipe;
  light.payload_kg[1] = 2.0 * config.arm.payload_mass_kg;
  std::vector<Scenario> scenarios = {
      RandomScenario(config, recipe, {.name = "nominal", .what = Payloads(recipe)})};
  if (light.payload_kg[0] < light.payload_kg[1] && light.payload_kg[1] < recipe.payload_kg[1]) {
    scenarios.push_back(RandomScenario(config, light, {.name = "light", .what = Payloads(light)}));
  }
  for (const auto& disturbances : {CommonDisturbances(config), MorePlants(config)}) {
    for (const Disturbance& d : disturbances) {
      scenarios.push_back(RandomScenario(config, recipe, d));
    }
  }
  scenarios.push_back(RandomScenario(config, recipe, FineTheta1(config)));
  scenarios.push_back(RandomScenario(config, recipe, FineEncoders(config)));
  return scenarios;
}

std::vector<Scenario> LimitScenarios(const RigConfig& config) {
  const Overrides theta1 = FineTheta1(config).config, encoders = FineEncoders(config).config;
  const std::vector<Disturbance> taken_away = {
      {.name = "nominal", .what = "the rig as it is"},
      FineTheta1(config),
      FineEncoders(config),
      {.name = "quiet-gauges", .what = "gauges without noise, 24 bits", .config = QuietGauges()},
      NoFriction(),
      {.name = "encoders-quiet",
       .what = "all encoders x 10, quiet gauges",
       .config = Both(encoders, QuietGauges())},
      {.name = "no-friction-theta1",
       .what = "no friction, encoder of theta1 x 10",
       .plant = kNoFriction,
       .config = theta1},
      {.name = "no-friction-encoders",
       .what = "no friction, all encoders x 10",
       .plant = kNoFriction,
       .config = encoders},
      {.name = "all",
       .what = "no friction, all encoders x 10, quiet gauges",
       .plant = kNoFriction,
       .config = Both(encoders, QuietGauges())},
  };
  std::vector<Scenario> scenarios;
  scenarios.reserve(taken_away.size());
  for (const Disturbance& d : taken_away) {
    scenarios.push_back(RandomScenario(config, RecipeFor(config), d));
  }
  return scenarios;
}

std::vector<Scenario> FastScenarios(const RigConfig& config) {
  MoveRecipe recipe = RecipeFor(config);
  recipe.within_deg[1] = std::min(recipe.within_deg[1], kFastElbow_deg);
  std::vector<Scenario> scenarios = {
      FastScenario(config, recipe, {.name = "nominal", .what = Payloads(recipe)})};
  const auto [least_kg, greatest_kg] = config.controller.payload_range_kg;
  for (const double share : {0.0, 0.1, 0.2, 0.5, 1.0}) {
    const double payload_kg = least_kg + share * (greatest_kg - least_kg);
    MoveRecipe fixed = recipe;
    fixed.payload_kg = {payload_kg, payload_kg};
    const std::string text = RoundedText(payload_kg, 3);
    scenarios.push_back(
        FastScenario(config, fixed, {.name = "payload-" + text, .what = text + " kg"}));
  }
  for (const auto& disturbances : {CommonDisturbances(config), MorePlants(config)}) {
    for (const Disturbance& d : disturbances) scenarios.push_back(FastScenario(config, recipe, d));
  }
  return scenarios;
}

}  // namespace flexarm
