#include <algorithm>
#include <array>
#include <set>

#include "config/fitted_experiment.h"
#include "config/thesis_arm.h"
#include "controller/types/rounded_text.h"
#include "tools/benchmark/benchmark_set.h"
#include "tools/benchmark/disturbance.h"

namespace flexarm {
namespace {

constexpr int kDigits = 3;

double Rounded(double value) { return std::stod(RoundedText(value, kDigits)); }

std::string Kilograms(double payload_kg) { return RoundedText(payload_kg, kDigits) + " kg"; }

// Payloads other than the nominal one: multiples of it, and the range that the rig is for.
std::vector<double> OtherPayloads_kg(const RigConfig& config) {
  const auto [least, most] = config.controller.payload_range_kg;
  const double nominal = config.arm.payload_mass_kg;
  std::set<double> payloads = {Rounded(least), Rounded(0.5 * most), Rounded(most)};
  for (const double factor : {0.0, 0.1, 0.5, 1.5, 2.0}) payloads.insert(Rounded(factor * nominal));
  std::erase_if(payloads, [&](double kg) {
    return kg < Rounded(least) || kg > Rounded(most) || kg == Rounded(nominal);
  });
  return {payloads.begin(), payloads.end()};
}

std::string WhatOf(double payload_kg, const RigConfig& config) {
  const double nominal = config.arm.payload_mass_kg;
  if (payload_kg == 0.0) return "no payload";
  if (payload_kg < Rounded(config.controller.payload_range_kg[1]) || payload_kg <= nominal ||
      nominal <= 0.0) {
    return Kilograms(payload_kg);
  }
  return Kilograms(payload_kg) + ", " + RoundedText(payload_kg / nominal, 2) +
         " times the design's";
}

/// Makes scenarios on the rig that the laws were designed for.
class Commands {
 public:
  Commands(const RigConfig& config, std::filesystem::path experiments)
      : config_(config), experiments_(std::move(experiments)) {}

  Scenario Of(const std::string& name, const std::string& what, double payload_kg,
              const std::string& experiment = "benchmark-square") const {
    const FittedExperiment fitted =
        FitExperiment(LoadExperiment(experiments_ / (experiment + ".toml")), config_);
    return {.name = name,
            .what = what + (fitted.how.empty() ? "" : " (" + fitted.how + ")"),
            .experiment = fitted.experiment,
            .payload_kg = payload_kg,
            .variant = "nominal",
            .plant = {},
            .config = {},
            .tuned_on = IsTunedOn(experiment, payload_kg)};
  }

 private:
  // Gains and estimators of the thesis's arm were chosen on the square command with these. Nothing
  // was tuned on the other plants and the other commands.
  bool IsTunedOn(const std::string& experiment, double payload_kg) const {
    constexpr std::array kTuned_kg = {0.0, 0.01, 0.1, 0.2};
    return experiment == "benchmark-square" && IsThesisArm(config_.arm) &&
           std::find(kTuned_kg.begin(), kTuned_kg.end(), payload_kg) != kTuned_kg.end();
  }

  const RigConfig& config_;
  std::filesystem::path experiments_;
};

// A payload for the smooth moves beside the nominal one; the nominal one if there is no other.
double AnotherPayload_kg(const RigConfig& config) {
  const double most_kg = config.controller.payload_range_kg[1];
  const double half_kg = Rounded(0.5 * most_kg);
  const bool is_other = half_kg != Rounded(config.arm.payload_mass_kg) &&
                        half_kg >= config.controller.payload_range_kg[0];
  return is_other ? half_kg : Rounded(most_kg);
}

}  // namespace

std::vector<Scenario> CommandScenarios(const RigConfig& config,
                                       const std::filesystem::path& experiments) {
  const Commands commands(config, experiments);
  const double nominal_kg = config.arm.payload_mass_kg;
  std::vector<Scenario> scenarios = {
      commands.Of("nominal", Kilograms(nominal_kg) + ", as designed for", nominal_kg)};
  for (const double payload_kg : OtherPayloads_kg(config)) {
    scenarios.push_back(commands.Of("payload-" + RoundedText(payload_kg, kDigits),
                                    WhatOf(payload_kg, config), payload_kg));
  }
  scenarios.push_back(commands.Of("sine", "sine doublets", nominal_kg, "benchmark-sine"));
  scenarios.push_back(commands.Of("waypoints", "smooth moves", nominal_kg, "benchmark-waypoints"));
  if (const double kg = AnotherPayload_kg(config); kg != Rounded(nominal_kg)) {
    scenarios.push_back(commands.Of("waypoints-" + RoundedText(kg, kDigits),
                                    "smooth moves, " + Kilograms(kg), kg, "benchmark-waypoints"));
  }
  scenarios.push_back(
      commands.Of("unseen", "another square command", nominal_kg, "benchmark-unseen"));
  const Scenario nominal = scenarios.front();
  for (const Disturbance& d : CommonDisturbances(config)) {
    scenarios.push_back({.name = d.name,
                         .what = d.what,
                         .experiment = nominal.experiment,
                         .payload_kg = nominal.payload_kg,
                         .variant = d.variant,
                         .plant = d.plant,
                         .config = d.config,
                         .tuned_on = false});
  }
  return scenarios;
}

}  // namespace flexarm
