#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tools/runs/run_summary.h"

namespace flexarm {

/// Data of the pictures of a run, in their units. Time 0 is the start of the experiment, or of the
/// log without an experiment.
struct PlotRun {
  struct Sample {
    double time_s;
    std::array<double, 2> reference_deg, angle_deg, asked_nm, applied_nm, deflection_mm;
    std::array<double, 2> gated_nm;  ///< applied, where the gate changed it; NaN elsewhere
    double from_rest_mm;  ///< distance of the tip from its resting place; NaN without an experiment
    std::array<double, 2> tip_m;
  };
  struct StateSpan {
    double from_s, until_s;
    SafetyState state;
  };
  /// The arm seen from above at one instant, root to tip.
  struct Pose {
    double time_s;
    std::vector<std::array<double, 2>> point_m;
  };

  /// A move and the rest after it.
  struct Act {
    double from_s, until_s;
  };

  std::string name;
  double period_s;
  bool truth;        ///< angles, tip and deflections are the plant's own
  std::string trip;  ///< machine name; empty: none
  std::vector<Sample> sample;
  std::vector<StateSpan> span;
  std::vector<Pose> pose;
  std::vector<Act> act;  ///< at least one
  std::optional<RunMetrics> metrics;
};

PlotRun PlotDataOf(const LoadedRun& run);

}  // namespace flexarm
