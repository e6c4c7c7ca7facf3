#pragma once

#include <cmath>
#include <limits>

#include "tools/plot/plot_data.h"

namespace flexarm {

/// A run of `samples` samples at 50 Hz that swings by a degree, with a payload estimate and one
/// move.
inline PlotRun PlottedRun(std::size_t samples) {
  PlotRun run{.name = "run",
              .title = "waypoints, sobel on rig",
              .details = "2026-01-01",
              .command = "flexarm replay run.flexarm",
              .period_s = 0.02,
              .truth = true,
              .trip = {},
              .torque_limit_nm = {30.0, 6.0},
              .strain_limit = {1.9e-3, 1.9e-3},
              .settled_within_mm = 15.0,
              .sample = {},
              .gap = {},
              .span = {},
              .mark = {},
              .act = {},
              .view = {},
              .metrics = {}};
  for (std::size_t i = 0; i < samples; ++i) {
    const double time_s = 0.02 * static_cast<double>(i), swing = std::sin(time_s);
    run.sample.push_back({.time_s = time_s,
                          .reference_deg = {swing, -swing},
                          .angle_deg = {swing, -swing},
                          .asked_nm = {swing, swing},
                          .applied_nm = {swing, swing},
                          .deflection_mm = {swing, swing},
                          .gated_nm = {std::nan(""), std::nan("")},
                          .strain_share = {0.1 * swing, 0.2 * swing},
                          .target_mm = 10.0,
                          .tip_m = {1.7, 0.0},
                          .payload_kg = 0.3,
                          .payload_sigma_kg = 0.02});
  }
  const double end_s = run.sample.empty() ? 1.0 : run.sample.back().time_s;
  run.span.push_back({0.0, end_s, SafetyState::kRunning});
  run.act.push_back({.from_s = 0.0, .rest_from_s = end_s, .until_s = end_s});
  run.view.push_back({.number = 1,
                      .from_s = 0.0,
                      .until_s = end_s,
                      .pose = {{.time_s = 0.0, .point_m = {{0.0, 0.0}, {0.8, 0.0}, {1.7, 0.0}}}},
                      .path = {{1.7, 0.0}, {1.6, 0.1}}});
  return run;
}

}  // namespace flexarm
