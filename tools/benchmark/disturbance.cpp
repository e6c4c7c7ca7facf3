#include "tools/benchmark/disturbance.h"

namespace flexarm {

std::vector<Disturbance> CommonDisturbances() {
  return {
      {.name = "soft-joints", .what = "joint stiffness -30 %", .variant = "soft-joints"},
      {.name = "soft-links", .what = "Young's modulus -10 %", .variant = "soft-links"},
      {.name = "backlash", .what = "1 degree of backlash at the elbow", .variant = "backlash"},
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
       .what = "one more sample of delay, undeclared",
       .plant = {"sim.transport_delay_ms=20"}},
  };
}

}  // namespace flexarm
