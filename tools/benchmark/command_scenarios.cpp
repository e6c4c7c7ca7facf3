#include "tools/benchmark/benchmark_set.h"
#include "tools/benchmark/disturbance.h"

namespace flexarm {
namespace {

// A scenario on the rig that the laws were designed for.
struct Row {
  const char* name;
  const char* what;
  const char* experiment = "benchmark-square";
  double payload_kg = 0.1;
  bool tuned_on = false;
};

// Gains and estimators were chosen on the square command with 0 to 0.2 kg. Nothing was tuned on the
// other plants and the other commands.
std::vector<Row> Rows() {
  return {
      {.name = "nominal", .what = "0.1 kg, as designed for", .tuned_on = true},
      {.name = "payload-0", .what = "no payload", .payload_kg = 0.0, .tuned_on = true},
      {.name = "payload-0.01", .what = "0.01 kg", .payload_kg = 0.01, .tuned_on = true},
      {.name = "payload-0.05", .what = "0.05 kg", .payload_kg = 0.05},
      {.name = "payload-0.15", .what = "0.15 kg", .payload_kg = 0.15},
      {.name = "payload-0.2", .what = "0.2 kg", .payload_kg = 0.2, .tuned_on = true},
      {.name = "payload-0.5", .what = "0.5 kg", .payload_kg = 0.5},
      {.name = "payload-1", .what = "1 kg, ten times the design's", .payload_kg = 1.0},
      {.name = "sine", .what = "sine doublets", .experiment = "benchmark-sine"},
      {.name = "waypoints", .what = "smooth moves", .experiment = "benchmark-waypoints"},
      {.name = "waypoints-0.5",
       .what = "smooth moves, 0.5 kg",
       .experiment = "benchmark-waypoints",
       .payload_kg = 0.5},
      {.name = "unseen", .what = "another square command", .experiment = "benchmark-unseen"},
  };
}

}  // namespace

std::vector<Scenario> CommandScenarios(const std::filesystem::path& experiments) {
  std::vector<Scenario> scenarios;
  for (const Row& row : Rows()) {
    scenarios.push_back(
        {.name = row.name,
         .what = row.what,
         .experiment = LoadExperiment(experiments / (std::string(row.experiment) + ".toml")),
         .payload_kg = row.payload_kg,
         .variant = "nominal",
         .plant = {},
         .config = {},
         .tuned_on = row.tuned_on});
  }
  const Scenario nominal = scenarios.front();
  for (const Disturbance& d : CommonDisturbances()) {
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
