#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "controller/types/control_config.h"
#include "controller/types/experiment.h"
#include "controller/types/records.h"
#include "estimator/state_layout.h"

namespace flexarm {

/// How long a move took in the end, from its start until the tip stays within the distance that
/// counts as settled (tip_tolerance.h) of a place for the rest of its rest; it may be shorter than
/// the move. Nothing: never.
struct Arrival {
  double start_s;                     ///< of the move
  std::optional<double> at_rest_s;    ///< the place where the tip rests, over the last 0.3 s
  std::optional<double> on_target_s;  ///< the target
};

/// Performance metrics of a run (docs/benchmark.md, "Settled"). A metric for which the run was too
/// short is NaN.
struct RunMetrics {
  std::int64_t ticks = 0;                         ///< in state Running
  std::array<double, 2> joint_rms_error_deg{};    ///< against the reference model, all ticks
  std::array<double, 2> joint_peak_error_deg{};   ///< largest |error| of them
  std::array<double, 2> joint_final_error_deg{};  ///< largest over the rests of |mean, last 0.3 s|
  /// Settling time, largest over the rests: from the end of the move until the rest is settled: the
  /// tip stays within TipGeometry::settled_within_m of its resting place, its mean over the last
  /// 0.3 s of the rest, and that place is within it of the target: the tip with the joints where
  /// the reference ends and both links straight. Nothing: a rest is not settled.
  std::optional<double> tip_settling_time_s;
  /// Largest over the rests: distance of the resting place from the target.
  double tip_target_error_mm = 0;
  double tip_residual_rms_mm = 0;  ///< largest over the rests: rms about that mean, last 0.3 s
  /// Mean over the rests: the tip's rms about its mean from 0.3 s after the move's end to the end
  /// of the rest (the motion of docs/theory/payload.md 6.1), so slow oscillations count too.
  double tip_motion_rms_mm = 0;
  /// How long the motion lasts, largest over the rests: from the end of the move until the tip
  /// stays within 15 mm, 5 mm of its resting place, wherever that is. Nothing: never.
  std::optional<double> tip_still_within_15mm_s, tip_still_within_5mm_s;
  /// The tip's rms about its mean in the last second of the last rest, or in all of a shorter one.
  double tip_last_second_rms_mm = 0;
  std::array<double, 2> peak_angle_deg{};  ///< largest |hub angle|
  /// Rms over the rests of the second difference of the hub angle, over period squared: how rough
  /// it comes to rest.
  std::array<double, 2> joint_roughness_rad_s2{};
  /// Lag behind the reference that fits the errors best, linearised: -sum e r' / sum r'^2.
  std::array<double, 2> joint_lag_s{};
  std::array<double, 2> peak_torque_nm{};   ///< after the gate
  std::array<double, 2> torque_rms_nm{};    ///< after the gate, all ticks
  std::array<double, 2> peak_bending_mm{};  ///< largest deflection of each link's tip
  std::vector<Arrival> arrival;             ///< of the motions with a rest, in order of time
  bool truth = false;  ///< angles and tip are the plant's true ones; otherwise estimated
};

/// An interval without a move, in seconds after sample 0 of the experiment.
struct Rest {
  double start_s;
  double end_s;
  double motion_s = 0.0;  ///< start of the motion before it
};

/// From the end of each move to the start of the next, or to `run_end_s`. Rests that the run did
/// not reach are left out, and one in which it was stopped before there were 0.3 s to judge; a move
/// that the next one retargets has none.
std::vector<Rest> RestsOf(const Experiment& experiment, double run_end_s);

/// Data for an estimated tip position: the layout of the state, rigid geometry, and the tip slopes
/// of link 1's modes; and how near the tip must be to count as settled.
struct TipGeometry {
  StateLayout layout;
  std::array<double, 2> length_m;
  std::array<double, 2> tip_slope_per_m;  ///< psi_1j'(L1), j = 1, 2
  double settled_within_m;                ///< SettledWithin_m
};

TipGeometry TipGeometryOf(const ControlConfig& config);

/// Elastic tip deflection of each link, m: the sum of its modal coordinates, as psi(L) = 1.
std::array<double, 2> EstimatedDeflection_m(const StateLayout& layout,
                                            const std::array<double, kMaxNominalStates>& x);

/// Tip in the base frame; slopes as arctangents, as in the model.
std::array<double, 2> EstimatedTip(const TipGeometry& geometry,
                                   const std::array<double, kMaxNominalStates>& x);

/// The tip with the hubs of `x` and straight links, in the base frame, m: the target, if `x` is
/// where the reference ends.
std::array<double, 2> StraightTip(const TipGeometry& geometry,
                                  const std::array<double, kMaxNominalStates>& x);

/// Computes the metrics of the first interval of ticks in state Running. Sample 0 of the experiment
/// is the sampling instant after the first of them.
RunMetrics ComputeMetrics(std::span<const TickRecord> ticks, const Experiment& experiment,
                          double period_s, const TipGeometry& geometry);

}  // namespace flexarm
