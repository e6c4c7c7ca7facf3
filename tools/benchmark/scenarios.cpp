#include "tools/benchmark/benchmark.h"

namespace flexarm {
namespace {

// Of a scenario that differs from the nominal one in little.
struct Row {
  const char* name;
  const char* what;
  const char* experiment = "benchmark-square";
  double payload_kg = 0.1;
  const char* variant = "nominal";
  std::vector<std::string> plant{};
  std::vector<std::string> config{};
  bool tuned_on = false;
};

// Gains and estimators were chosen on the square command with 0 to 0.2 kg; the plants that differ,
// and all the rest, are met here for the first time.
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
      {.name = "soft-joints", .what = "joint stiffness -30 %", .variant = "soft-joints"},
      {.name = "soft-links", .what = "Young's modulus -10 %", .variant = "soft-links"},
      {.name = "backlash", .what = "1 degree of play at the elbow", .variant = "backlash"},
      {.name = "friction-x3", .what = "Coulomb friction x 3", .variant = "friction-x3"},
      {.name = "noise-x3",
       .what = "noise of the gauges x 3",
       .plant = {"sensors.strain_input.noise_counts=3"}},
      {.name = "lost-frames",
       .what = "one frame in ten lost",
       .plant = {"sim.lost_frame_fraction=0.1"}},
      {.name = "delay-0",
       .what = "torques put out 5 ms after the sample, not at the next tick",
       .config = {"loop.acquire_before_ms=3", "loop.step_deadline_ms=2", "loop.output_after_ms=5",
                  "loop.output=at_once"}},
      {.name = "delay-2",
       .what = "a sample more of delay, declared",
       .config = {"sim.transport_delay_ms=20", "loop.actuation_delay_ms=20"}},
      {.name = "delay-2-unknown",
       .what = "a sample more of delay that nobody was told of",
       .plant = {"sim.transport_delay_ms=20"}},
  };
}

}  // namespace

std::vector<Scenario> BenchmarkScenarios(const std::filesystem::path& experiments) {
  std::vector<Scenario> scenarios;
  for (const Row& row : Rows()) {
    scenarios.push_back(
        {.name = row.name,
         .what = row.what,
         .experiment = LoadExperiment(experiments / (std::string(row.experiment) + ".toml")),
         .payload_kg = row.payload_kg,
         .variant = row.variant,
         .plant = row.plant,
         .config = row.config,
         .tuned_on = row.tuned_on});
  }
  return scenarios;
}

std::vector<std::string> BenchmarkLaws() {
  return {"sobel", "sobel-original", "lqr-cgt", "lqr-um", "lqg", "pd", "pd-zv", "pd-zvd"};
}

}  // namespace flexarm
