#include "controller/runlog/metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "controller/runlog/durations_of_run.h"
#include "controller/types/tip_tolerance.h"
#include "model/beam/link_modes.h"
#include "model/units.h"

namespace flexarm {
namespace {

constexpr double kFinalWindow_s = 0.3;
constexpr double kStillWithin_m = 0.015, kFinelyStillWithin_m = 0.005;
constexpr double kLongWindow_s = 1.0;
constexpr double kSettleBy_s = 0.3;  // goal: settled this long after the end of a move

// Values of one tick that the metrics use.
struct Sample {
  double time_s;  // after sample 0 of the experiment
  std::array<double, 2> angle_deg, error_deg;
  std::array<double, 2> reference_deg_s;
  std::array<double, 2> tip_m;
  std::array<double, 2> target_m;  // the tip with the joints on their reference, links straight
};

double Distance(const std::array<double, 2>& a, const std::array<double, 2>& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1]);
}

std::span<const TickRecord> FirstRunningSegment(std::span<const TickRecord> ticks) {
  const auto running = [](const TickRecord& record) {
    return record.input.safety_state == SafetyState::kRunning;
  };
  const auto first = std::find_if(ticks.begin(), ticks.end(), running);
  return {first, std::find_if_not(first, ticks.end(), running)};
}

std::vector<Sample> Samples(std::span<const TickRecord> ticks, double period_s, bool truth,
                            const TipGeometry& geometry) {
  std::vector<Sample> samples;
  samples.reserve(ticks.size());
  const double late_s =
      ticks.empty() ? 0.0 : 1e-9 * static_cast<double>(ticks.front().input.acts_late_ns);
  for (const TickRecord& record : ticks) {
    const std::int64_t number = record.input.tick - ticks.front().input.tick - 1;
    Sample sample{.time_s = static_cast<double>(number) * period_s - late_s,
                  .angle_deg = {},
                  .error_deg = {},
                  .reference_deg_s = {},
                  .tip_m = truth ? record.truth.tip_m : EstimatedTip(geometry, record.output.x_hat),
                  .target_m = StraightTip(geometry, record.input.reference_now.x_m)};
    for (std::size_t joint = 0; joint < 2; ++joint) {
      const double angle = truth ? record.truth.hub_angle_rad[joint] : record.output.x_hat[joint];
      const int rate = geometry.layout.rate(geometry.layout.hub(static_cast<int>(joint)));
      sample.angle_deg[joint] = angle * kDegPerRad;
      sample.reference_deg_s[joint] =
          record.input.reference_now.x_m[static_cast<std::size_t>(rate)] * kDegPerRad;
      sample.error_deg[joint] = (angle - record.input.reference_now.x_m[joint]) * kDegPerRad;
    }
    samples.push_back(sample);
  }
  return samples;
}

// Half a period of tolerance at the borders: times are multiples of the period except for
// round-off.
std::span<const Sample> Between(std::span<const Sample> samples, double after_s, double until_s,
                                double slack_s) {
  const auto before = [](double limit) {
    return [limit](const Sample& sample) { return sample.time_s < limit; };
  };
  const auto first = std::find_if_not(samples.begin(), samples.end(), before(after_s + slack_s));
  return {first, std::find_if_not(first, samples.end(), before(until_s + slack_s))};
}

void JudgeFinalError(std::span<const Sample> window, RunMetrics* metrics) {
  for (std::size_t joint = 0; joint < 2; ++joint) {
    double sum = 0;
    for (const Sample& sample : window) sum += sample.error_deg[joint];
    double& largest = metrics->joint_final_error_deg[joint];
    largest = std::max(largest, std::abs(sum / static_cast<double>(window.size())));
  }
}

std::array<double, 2> MeanTip(std::span<const Sample> window) {
  std::array<double, 2> mean{};
  for (const Sample& sample : window) {
    for (std::size_t axis = 0; axis < 2; ++axis) mean[axis] += sample.tip_m[axis];
  }
  for (double& value : mean) value /= static_cast<double>(window.size());
  return mean;
}

// @returns the time after the start of the rest from which the tip stays within the bound; nothing
// if it does not
std::optional<double> StillAfter_s(std::span<const Sample> rest, double start_s,
                                   const std::array<double, 2>& place, double within_m) {
  std::size_t settled = rest.size();
  while (settled > 0 && Distance(rest[settled - 1].tip_m, place) <= within_m) --settled;
  if (settled == rest.size()) return std::nullopt;
  return std::max(0.0, rest[settled].time_s - start_s);
}

double ResidualRms_mm(std::span<const Sample> window, const std::array<double, 2>& place) {
  double sum = 0;
  for (const Sample& sample : window) {
    const double distance_mm = 1e3 * Distance(sample.tip_m, place);
    sum += distance_mm * distance_mm;
  }
  return std::sqrt(sum / static_cast<double>(window.size()));
}

// The last 0.3 s of a rest, or all of a shorter one.
std::span<const Sample> FinalWindow(std::span<const Sample> samples, const Rest& rest,
                                    double slack_s, double window_s = kFinalWindow_s) {
  const double start_s = std::max(rest.start_s, rest.end_s - window_s);
  return Between(samples, start_s, rest.end_s, slack_s);
}

// From 0.3 s after the move's end on, or the last window of a rest too short for that.
std::span<const Sample> AfterSettling(std::span<const Sample> samples, const Rest& rest,
                                      double slack_s) {
  const double start_s = std::min(rest.start_s + kSettleBy_s, rest.end_s - kFinalWindow_s);
  return Between(samples, std::max(rest.start_s, start_s), rest.end_s, slack_s);
}

// The largest of the times so far and of one more rest; nothing: never.
void TakeLonger(const std::optional<double>& time_s, std::optional<double>* longest) {
  if (!time_s) {
    longest->reset();
  } else if (*longest) {
    *longest = std::max(**longest, *time_s);
  }
}

void JudgeRests(std::span<const Sample> samples, std::vector<Rest> rests, double slack_s,
                double settled_within_m, RunMetrics* metrics) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::erase_if(rests,
                [&](const Rest& rest) { return FinalWindow(samples, rest, slack_s).empty(); });
  if (rests.empty()) {
    metrics->joint_final_error_deg = {kNone, kNone};
    metrics->tip_residual_rms_mm = metrics->tip_motion_rms_mm = kNone;
    metrics->tip_last_second_rms_mm = metrics->tip_target_error_mm = kNone;
    return;
  }
  metrics->tip_still_within_15mm_s = metrics->tip_still_within_5mm_s = 0;
  std::optional<double> settling_s = 0;
  for (const Rest& rest : rests) {
    const auto all = Between(samples, rest.start_s - 2 * slack_s, rest.end_s, slack_s);
    const auto window = FinalWindow(samples, rest, slack_s);
    JudgeFinalError(window, metrics);
    const std::array<double, 2> place = MeanTip(window);
    metrics->tip_target_error_mm =
        std::max(metrics->tip_target_error_mm, 1e3 * Distance(place, window.back().target_m));
    metrics->tip_residual_rms_mm =
        std::max(metrics->tip_residual_rms_mm, ResidualRms_mm(window, place));
    const auto after = AfterSettling(samples, rest, slack_s);
    metrics->tip_motion_rms_mm +=
        ResidualRms_mm(after, MeanTip(after)) / static_cast<double>(rests.size());
    const auto last = FinalWindow(samples, rest, slack_s, kLongWindow_s);
    metrics->tip_last_second_rms_mm = ResidualRms_mm(last, MeanTip(last));  // the last rest's stays
    const auto whole = Between(samples, rest.motion_s - 2 * slack_s, rest.end_s, slack_s);
    metrics->arrival.push_back(
        {.start_s = rest.motion_s,
         .at_rest_s = StillAfter_s(whole, rest.motion_s, place, settled_within_m),
         .on_target_s =
             StillAfter_s(whole, rest.motion_s, window.back().target_m, settled_within_m)});
    TakeLonger(StillAfter_s(all, rest.start_s, place, kStillWithin_m),
               &metrics->tip_still_within_15mm_s);
    TakeLonger(StillAfter_s(all, rest.start_s, place, kFinelyStillWithin_m),
               &metrics->tip_still_within_5mm_s);
    TakeLonger(StillAfter_s(all, rest.start_s, place, settled_within_m), &settling_s);
  }
  if (metrics->tip_target_error_mm <= 1e3 * settled_within_m) {
    metrics->tip_settling_time_s = settling_s;
  }
}

void JudgeRoughness(std::span<const Sample> samples, const std::vector<Rest>& rests,
                    double period_s, RunMetrics* metrics) {
  for (std::size_t joint = 0; joint < 2; ++joint) {
    double squares = 0;
    std::size_t count = 0;
    for (const Rest& rest : rests) {
      const auto all = Between(samples, rest.start_s, rest.end_s, period_s / 2);
      for (std::size_t i = 2; i < all.size(); ++i, ++count) {
        const double second = all[i].angle_deg[joint] - 2.0 * all[i - 1].angle_deg[joint] +
                              all[i - 2].angle_deg[joint];
        squares += second * second;
      }
    }
    metrics->joint_roughness_rad_s2[joint] =
        std::sqrt(squares / static_cast<double>(count)) / (period_s * period_s * kDegPerRad);
  }
}

void JudgeShape(std::span<const Sample> samples, RunMetrics* metrics) {
  for (std::size_t joint = 0; joint < 2; ++joint) {
    double along = 0, rate_squares = 0;
    for (const Sample& sample : samples) {
      metrics->peak_angle_deg[joint] =
          std::max(metrics->peak_angle_deg[joint], std::abs(sample.angle_deg[joint]));
      along += sample.error_deg[joint] * sample.reference_deg_s[joint];
      rate_squares += sample.reference_deg_s[joint] * sample.reference_deg_s[joint];
    }
    metrics->joint_lag_s[joint] = -along / rate_squares;
  }
}

void JudgeAllTicks(std::span<const TickRecord> ticks, std::span<const Sample> samples,
                   const StateLayout& layout, RunMetrics* metrics) {
  for (std::size_t joint = 0; joint < 2; ++joint) {
    double sum = 0, peak = 0;
    for (const Sample& sample : samples) {
      sum += sample.error_deg[joint] * sample.error_deg[joint];
      peak = std::max(peak, std::abs(sample.error_deg[joint]));
    }
    metrics->joint_peak_error_deg[joint] = peak;
    metrics->joint_rms_error_deg[joint] = std::sqrt(sum / static_cast<double>(samples.size()));
    double torque_squared = 0;
    for (const TickRecord& record : ticks) {
      const double torque_nm = record.input.applied_torque_nm[joint];
      metrics->peak_torque_nm[joint] =
          std::max(metrics->peak_torque_nm[joint], std::abs(torque_nm));
      torque_squared += torque_nm * torque_nm;
      const double bending_m = metrics->truth
                                   ? record.truth.tip_deflection_m[joint]
                                   : EstimatedDeflection_m(layout, record.output.x_hat)[joint];
      metrics->peak_bending_mm[joint] =
          std::max(metrics->peak_bending_mm[joint], 1e3 * std::abs(bending_m));
    }
    metrics->torque_rms_nm[joint] = std::sqrt(torque_squared / static_cast<double>(ticks.size()));
  }
}

}  // namespace

std::vector<Rest> RestsOf(const Experiment& experiment, double run_end_s) {
  std::vector<Rest> rests;
  const double end_s = std::min(run_end_s, experiment.duration_s);
  const std::vector<Motion> motions = experiment.Motions();
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const bool last = i + 1 == motions.size();
    const double planned_end_s = last ? experiment.duration_s : motions[i + 1].start_s;
    const Rest rest{.start_s = motions[i].start_s + motions[i].duration_s,
                    .end_s = std::min(end_s, planned_end_s),
                    .motion_s = motions[i].start_s};
    const bool is_cut = planned_end_s - rest.end_s > kFinalWindow_s / 2;
    if (rest.end_s - rest.start_s > (is_cut ? kFinalWindow_s : 0)) rests.push_back(rest);
  }
  return rests;
}

TipGeometry TipGeometryOf(const ControlConfig& config) {
  const ArmParameters& arm = config.arm;
  const LinkModes modes = Link1Modes(arm, 2);
  return {.layout = config.controller.nominal,
          .length_m = {arm.link[0].length_m(), arm.link[1].length_m()},
          .tip_slope_per_m = {modes.slope_tip(0), modes.slope_tip(1)},
          .settled_within_m = SettledWithin_m(config)};
}

std::array<double, 2> EstimatedDeflection_m(const StateLayout& layout,
                                            const std::array<double, kMaxNominalStates>& x) {
  std::array<double, 2> deflection{};
  for (int link = 0; link < 2; ++link) {
    for (int mode = 0; mode < layout.modes_per_link; ++mode) {
      deflection[static_cast<std::size_t>(link)] +=
          x[static_cast<std::size_t>(layout.mode(link, mode))];
    }
  }
  return deflection;
}

std::array<double, 2> EstimatedTip(const TipGeometry& geometry,
                                   const std::array<double, kMaxNominalStates>& x) {
  const StateLayout& layout = geometry.layout;
  const auto& [length1, length2] = geometry.length_m;
  const double th1 = x[static_cast<std::size_t>(layout.hub(0))];
  const double th2 = x[static_cast<std::size_t>(layout.hub(1))];
  const auto [w1, w2] = EstimatedDeflection_m(layout, x);
  double slope = 0.0;
  for (int mode = 0; mode < layout.modes_per_link; ++mode) {
    slope += geometry.tip_slope_per_m[static_cast<std::size_t>(mode)] *
             x[static_cast<std::size_t>(layout.mode(0, mode))];
  }
  const double alpha1 = std::atan(slope);
  const double gamma = th1 + alpha1 + th2;
  return {std::cos(th1) * length1 - std::sin(th1) * w1 + std::cos(gamma) * length2 -
              std::sin(gamma) * w2,
          std::sin(th1) * length1 + std::cos(th1) * w1 + std::sin(gamma) * length2 +
              std::cos(gamma) * w2};
}

std::array<double, 2> StraightTip(const TipGeometry& geometry,
                                  const std::array<double, kMaxNominalStates>& x) {
  std::array<double, kMaxNominalStates> straight{};
  for (int joint = 0; joint < 2; ++joint) {
    const auto hub = static_cast<std::size_t>(geometry.layout.hub(joint));
    straight[hub] = x[hub];
  }
  return EstimatedTip(geometry, straight);
}

RunMetrics ComputeMetrics(std::span<const TickRecord> ticks, const Experiment& experiment,
                          double period_s, const TipGeometry& geometry) {
  RunMetrics metrics;
  const auto running = FirstRunningSegment(ticks);
  metrics.ticks = static_cast<std::int64_t>(running.size());
  metrics.truth =
      !running.empty() && std::all_of(running.begin(), running.end(),
                                      [](const TickRecord& record) { return record.truth.known; });
  const auto samples = Samples(running, period_s, metrics.truth, geometry);
  const double run_end_s = samples.empty() ? 0 : samples.back().time_s;
  const std::vector<Rest> rests =
      RestsOf(WithDurationsOfRun(experiment, running, period_s), run_end_s);
  JudgeRests(samples, rests, period_s / 2, geometry.settled_within_m, &metrics);
  if (samples.empty()) {
    metrics.joint_rms_error_deg.fill(std::numeric_limits<double>::quiet_NaN());
    metrics.joint_peak_error_deg.fill(std::numeric_limits<double>::quiet_NaN());
    metrics.torque_rms_nm.fill(std::numeric_limits<double>::quiet_NaN());
  } else {
    JudgeAllTicks(running, samples, geometry.layout, &metrics);
    JudgeShape(samples, &metrics);
    JudgeRoughness(samples, rests, period_s, &metrics);
  }
  return metrics;
}

}  // namespace flexarm
