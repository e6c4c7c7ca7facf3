#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "tools/runs/run_summary.h"

namespace flexarm {

/// Data of the pictures of a run, in their units. Time 0 is the start of the experiment, or of the
/// log without an experiment. NaN: no value.
struct PlotRun {
  struct Sample {
    double time_s;
    std::array<double, 2> reference_deg;  ///< NaN while the loop follows none
    std::array<double, 2> angle_deg, asked_nm, applied_nm, deflection_mm;
    std::array<double, 2> gated_nm;      ///< applied, where the gate changed it; NaN elsewhere
    std::array<double, 2> strain_share;  ///< fitted strain at the root of each link over its limit
    double target_mm;  ///< distance of the tip from the target of the move (metrics.h)
    std::array<double, 2> tip_m;
    double payload_kg, payload_sigma_kg;  ///< NaN: the law does not estimate them
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
    double from_s, rest_from_s, until_s;
  };
  /// One act from above.
  struct View {
    std::size_t number;  ///< of the act, from 1
    double from_s, until_s;
    std::vector<Pose> pose;                   ///< a few, evenly spaced
    std::vector<std::array<double, 2>> path;  ///< of the tip, m
  };
  static constexpr std::size_t kMostViews = 6;
  /// What is marked on the time axis: a trip, a command, a warning, an event of the experiment.
  struct Mark {
    double at_s;
    std::string text;
    bool trips;
  };
  /// Samples that are missing from the log.
  struct Gap {
    double from_s, until_s;
    std::int64_t samples;
  };

  std::string name;     ///< of the file
  std::string title;    ///< experiment, law, rig
  std::string details;  ///< date, payload, seed, file
  std::string command;  ///< that replays the run
  double period_s;
  bool truth;        ///< angles, tip and deflections are the plant's own
  std::string trip;  ///< "bending-strain-1: 2057 of 1900 at 0.46 s"; empty: none
  std::array<double, 2> torque_limit_nm, strain_limit;
  double settled_within_mm;  ///< SettledWithin_m
  std::vector<Sample> sample;
  std::vector<Gap> gap;
  std::vector<StateSpan> span;
  std::vector<Mark> mark;  ///< in order of time
  std::vector<Act> act;    ///< at least one
  std::vector<View> view;  ///< of all acts, or of kMostViews of them, evenly spaced
  std::optional<RunMetrics> metrics;
};

PlotRun PlotDataOf(const LoadedRun& run);

/// The arm at `most` instants at most, evenly spaced over the samples of state Running in
/// [from_s, until_s].
/// @param points_per_link  points from root to tip, the root not counted
std::vector<PlotRun::Pose> PosesOf(const LoadedRun& run, double from_s, double until_s,
                                   std::size_t most, int points_per_link);

}  // namespace flexarm
