#include "tools/benchmark/disturbance.h"

#include <algorithm>
#include <cmath>

#include "controller/types/rounded_text.h"

namespace flexarm {
namespace {

constexpr int kExact = 12;

std::string Set(const std::string& key, double value) {
  return key + "=" + RoundedText(value, kExact);
}

// The torque acts a quarter of a period after the sample, in whole steps of the plant.
Disturbance AtOnce(const RigConfig& config) {
  constexpr double kRoundOff = 1e-9;
  const double period_ms = config.loop.period_ms, step_ms = config.sim.step_ms;
  const double acquire_ms =
      step_ms * std::max(1.0, std::floor(0.15 * period_ms / step_ms + kRoundOff));
  const double deadline_ms = 0.1 * period_ms;
  const double least_ms = std::max(0.25 * period_ms, acquire_ms + deadline_ms);
  const double output_ms = step_ms * std::ceil(least_ms / step_ms - kRoundOff);
  return {.name = "delay-0",
          .what = "torques put out " + RoundedText(output_ms, 3) +
                  " ms after the sample, not at the next tick",
          .config = {Set("loop.acquire_before_ms", acquire_ms),
                     Set("loop.step_deadline_ms", deadline_ms),
                     Set("loop.output_after_ms", output_ms), "loop.output=at_once"}};
}

}  // namespace

std::vector<Disturbance> CommonDisturbances(const RigConfig& config) {
  const std::string late = Set("sim.transport_delay_ms", config.loop.period_ms);
  return {
      {.name = "soft-joints", .what = "joint stiffness -30 %", .variant = "soft-joints"},
      {.name = "soft-links", .what = "Young's modulus -10 %", .variant = "soft-links"},
      {.name = "backlash", .what = "1 degree of backlash at the elbow", .variant = "backlash"},
      {.name = "friction-x3", .what = "Coulomb friction x 3", .variant = "friction-x3"},
      {.name = "noise-x3",
       .what = "noise of the gauges x 3",
       .plant = {Set("sensors.strain_input.noise_counts",
                     3.0 * config.sensors.strain_input.noise_counts)}},
      {.name = "lost-frames",
       .what = "one frame in ten lost",
       .plant = {"sim.lost_frame_fraction=0.1"}},
      AtOnce(config),
      {.name = "delay-2",
       .what = "a sample more of delay, declared",
       .config = {late, Set("loop.actuation_delay_ms", config.loop.period_ms)}},
      {.name = "delay-2-unknown", .what = "one more sample of delay, undeclared", .plant = {late}},
  };
}

}  // namespace flexarm
