#include "tools/plot/plot_data.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "controller/runlog/durations_of_run.h"
#include "controller/safety/torque_gate.h"
#include "model/units.h"
#include "tools/plot/run_marks.h"

namespace flexarm {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

bool IsRunning(const TickRecord& record) {
  return record.input.safety_state == SafetyState::kRunning;
}

std::array<double, 2> Scaled(double factor, double a, double b) { return {factor * a, factor * b}; }

// Of a sample of state Running.
std::array<double, 2> Gated(const TickRecord& record) {
  std::array<double, 2> gated_nm = record.input.applied_torque_nm;
  constexpr std::array<std::uint32_t, 2> kOfJoint = {kGateZeroed | kGateTorque1 | kGateSlew1,
                                                     kGateZeroed | kGateTorque2 | kGateSlew2};
  for (std::size_t i = 0; i < 2; ++i) {
    if (!IsRunning(record) || (record.gate_reasons & kOfJoint[i]) == 0) {
      gated_nm[i] = kNone;
    }
  }
  return gated_nm;
}

// What turns a record into a sample.
struct Scales {
  bool truth;
  TipGeometry geometry;
  std::array<double, 2> strain_limit;
};

PlotRun::Sample SampleOf(const TickRecord& record, double time_s, const Scales& scales) {
  const auto& x = record.output.x_hat;
  const auto& reference = record.input.reference_now.x_m;
  const PlantTruth& plant = record.truth;
  const bool truth = scales.truth;
  const auto deflection_m =
      truth ? plant.tip_deflection_m : EstimatedDeflection_m(scales.geometry.layout, x);
  const StepOutput& output = record.output;
  return {.time_s = time_s,
          .reference_deg = IsRunning(record) ? Scaled(kDegPerRad, reference[0], reference[1])
                                             : std::array{kNone, kNone},
          .angle_deg = truth ? Scaled(kDegPerRad, plant.hub_angle_rad[0], plant.hub_angle_rad[1])
                             : Scaled(kDegPerRad, x[0], x[1]),
          .asked_nm = output.torque_nm,
          .applied_nm = record.input.applied_torque_nm,
          .deflection_mm = Scaled(1e3, deflection_m[0], deflection_m[1]),
          .gated_nm = Gated(record),
          .strain_share = {output.root_strain[0] / scales.strain_limit[0],
                           output.root_strain[1] / scales.strain_limit[1]},
          .target_mm = kNone,
          .tip_m = truth ? plant.tip_m : EstimatedTip(scales.geometry, x),
          .payload_kg = output.payload_kg,
          .payload_sigma_kg = output.payload_sigma_kg};
}

// A move uses the target of the rest after it: where the reference is at the end of that rest.
void FillDistanceFromTarget(const LoadedRun& run, const std::vector<Rest>& rests,
                            const TipGeometry& geometry, std::vector<PlotRun::Sample>* samples) {
  std::size_t at = 0;
  for (const Rest& rest : rests) {
    const std::size_t first = at;
    while (at < samples->size() && (*samples)[at].time_s <= rest.end_s + 1e-9) ++at;
    if (at == first) continue;
    const auto target_m = StraightTip(geometry, run.contents.tick[at - 1].input.reference_now.x_m);
    for (std::size_t i = first; i < at; ++i) {
      PlotRun::Sample& sample = (*samples)[i];
      if (sample.time_s < 0.0) continue;
      sample.target_mm =
          1e3 * std::hypot(sample.tip_m[0] - target_m[0], sample.tip_m[1] - target_m[1]);
    }
  }
}

std::vector<PlotRun::Gap> GapsOf(const LoadedRun& run, std::int64_t zero_ns) {
  std::vector<PlotRun::Gap> gaps;
  const auto& ticks = run.contents.tick;
  const auto time_s = [zero_ns](const TickRecord& record) {
    return static_cast<double>(record.input.sampling_instant_ns - zero_ns) * 1e-9;
  };
  for (std::size_t i = 1; i < ticks.size(); ++i) {
    const std::int64_t missing = ticks[i].input.tick - ticks[i - 1].input.tick - 1;
    if (missing > 0) gaps.push_back({time_s(ticks[i - 1]), time_s(ticks[i]), missing});
  }
  return gaps;
}

std::vector<PlotRun::StateSpan> StateSpansOf(const LoadedRun& run, std::int64_t zero_ns) {
  std::vector<PlotRun::StateSpan> spans;
  const double period_s = run.period_s();
  for (const TickRecord& record : run.contents.tick) {
    const double time_s = static_cast<double>(record.input.sampling_instant_ns - zero_ns) * 1e-9;
    const SafetyState state = record.input.safety_state;
    if (!spans.empty() && spans.back().state == state) {
      spans.back().until_s = time_s + period_s;
    } else {
      spans.push_back({.from_s = time_s, .until_s = time_s + period_s, .state = state});
    }
  }
  return spans;
}

std::vector<PlotRun::Act> ActsOf(const std::optional<Experiment>& experiment,
                                 double running_end_s) {
  std::vector<PlotRun::Act> acts;
  if (experiment) {
    for (const Motion& move : experiment->Motions()) {
      if (move.start_s >= running_end_s) break;
      if (!acts.empty()) acts.back().until_s = move.start_s;
      acts.push_back({.from_s = move.start_s,
                      .rest_from_s = std::min(move.start_s + move.duration_s, running_end_s),
                      .until_s = running_end_s});
    }
  }
  if (acts.empty()) {
    const double end_s = std::max(running_end_s, 0.1);
    acts.push_back({.from_s = 0, .rest_from_s = end_s, .until_s = end_s});
  }
  return acts;
}

// All acts, or kMostViews of them: the first, the last, and those evenly between.
std::vector<PlotRun::View> ViewsOf(const LoadedRun& run, const PlotRun& plot) {
  constexpr std::size_t kPoses = 12;
  constexpr std::ptrdiff_t kMostPathPoints = 400;
  constexpr int kPointsPerLink = 16;
  std::vector<PlotRun::View> views;
  const std::size_t count = std::min(plot.act.size(), PlotRun::kMostViews);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t act = count == 1 ? 0 : i * (plot.act.size() - 1) / (count - 1);
    PlotRun::View view{.number = act + 1,
                       .from_s = plot.act[act].from_s,
                       .until_s = plot.act[act].until_s,
                       .pose = {},
                       .path = {}};
    const double moved_s = std::max(plot.act[act].rest_from_s, view.from_s + run.period_s());
    view.pose = PosesOf(run, view.from_s, moved_s, kPoses, kPointsPerLink);
    const auto before = [](const PlotRun::Sample& sample, double time_s) {
      return sample.time_s < time_s;
    };
    const auto first =
        std::lower_bound(plot.sample.begin(), plot.sample.end(), view.from_s, before);
    const auto last = std::lower_bound(first, plot.sample.end(), view.until_s, before);
    const auto step = 1 + (last - first) / kMostPathPoints;
    for (std::ptrdiff_t k = 0; k < last - first; k += step) view.path.push_back(first[k].tip_m);
    views.push_back(std::move(view));
  }
  return views;
}

}  // namespace

PlotRun PlotDataOf(const LoadedRun& run) {
  const auto& ticks = run.contents.tick;
  const SafetyConfig& safety = run.config.safety;
  const Scales scales{
      .truth = !ticks.empty() && std::all_of(ticks.begin(), ticks.end(),
                                             [](const auto& tick) { return tick.truth.known; }),
      .geometry = TipGeometryOf(run.config),
      .strain_limit = safety.strain_limit};
  const std::int64_t zero_ns = TimeZero_ns(run);
  PlotRun plot{.name = run.file.stem().string(),
               .title = TitleOf(run),
               .details = DetailsOf(run),
               .command = ReplayCommand(run),
               .period_s = run.period_s(),
               .truth = scales.truth,
               .trip = TripText(run, zero_ns),
               .torque_limit_nm = safety.torque_limit_nm,
               .strain_limit = safety.strain_limit,
               .settled_within_mm = 1e3 * scales.geometry.settled_within_m,
               .sample = {},
               .gap = GapsOf(run, zero_ns),
               .span = StateSpansOf(run, zero_ns),
               .mark = MarksOf(run, zero_ns),
               .act = {},
               .view = {},
               .metrics = MetricsOf(run)};
  double running_end_s = 0;
  for (const TickRecord& record : ticks) {
    const double time_s = static_cast<double>(record.input.sampling_instant_ns - zero_ns) * 1e-9;
    plot.sample.push_back(SampleOf(record, time_s, scales));
    if (IsRunning(record)) running_end_s = time_s;
  }
  std::optional<Experiment> experiment = run.experiment;
  if (experiment) experiment = WithDurationsOfRun(*experiment, ticks, run.period_s());
  plot.act = ActsOf(experiment, running_end_s);
  plot.view = ViewsOf(run, plot);
  if (experiment) {
    FillDistanceFromTarget(run, RestsOf(*experiment, running_end_s), scales.geometry, &plot.sample);
  }
  return plot;
}

}  // namespace flexarm
