#include "tools/plot/plot_data.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "controller/safety/torque_gate.h"
#include "model/beam/link_modes.h"
#include "model/units.h"

namespace flexarm {
namespace {

constexpr double kRestWindow_s = 0.3;
constexpr double kPoseEvery_s = 0.1;
constexpr int kPointsPerLink = 16;

bool IsRunning(const TickRecord& record) {
  return record.input.safety_state == SafetyState::kRunning;
}

// Time of sample 0 of the experiment: the torque of the first Running tick acts then.
std::int64_t TimeZero_ns(const LoadedRun& run) {
  const auto& ticks = run.contents.tick;
  const auto first = std::find_if(ticks.begin(), ticks.end(), IsRunning);
  if (first == ticks.end()) return run.contents.info.start_ns;
  return first->input.sampling_instant_ns + std::llround(run.period_s() * 1e9) +
         first->input.acts_late_ns;
}

std::array<double, 2> Scaled(double factor, double a, double b) { return {factor * a, factor * b}; }

// Of a sample of state Running.
std::array<double, 2> Gated(const TickRecord& record) {
  std::array<double, 2> gated_nm = record.input.applied_torque_nm;
  constexpr std::array<std::uint32_t, 2> kOfJoint = {kGateZeroed | kGateTorque1 | kGateSlew1,
                                                     kGateZeroed | kGateTorque2 | kGateSlew2};
  for (std::size_t i = 0; i < 2; ++i) {
    if (!IsRunning(record) || (record.gate_reasons & kOfJoint[i]) == 0) {
      gated_nm[i] = std::numeric_limits<double>::quiet_NaN();
    }
  }
  return gated_nm;
}

PlotRun::Sample SampleOf(const TickRecord& record, double time_s, bool truth,
                         const TipGeometry& geometry) {
  const auto& x = record.output.x_hat;
  const auto& reference = record.input.reference_now.x_m;
  const PlantTruth& plant = record.truth;
  const auto deflection_m = EstimatedDeflection_m(geometry.layout, x);
  return {.time_s = time_s,
          .reference_deg = Scaled(kDegPerRad, reference[0], reference[1]),
          .angle_deg = truth ? Scaled(kDegPerRad, plant.hub_angle_rad[0], plant.hub_angle_rad[1])
                             : Scaled(kDegPerRad, x[0], x[1]),
          .asked_nm = record.output.torque_nm,
          .applied_nm = record.input.applied_torque_nm,
          .deflection_mm = truth ? Scaled(1e3, plant.tip_deflection_m[0], plant.tip_deflection_m[1])
                                 : Scaled(1e3, deflection_m[0], deflection_m[1]),
          .gated_nm = Gated(record),
          .from_rest_mm = std::numeric_limits<double>::quiet_NaN(),
          .tip_m = truth ? plant.tip_m : EstimatedTip(geometry, x)};
}

// The resting place is the tip's mean over the last 0.3 s of a rest; a move uses the rest after it.
void FillDistanceFromRest(const std::vector<Rest>& rests, std::vector<PlotRun::Sample>* samples) {
  double from_s = 0;
  for (const Rest& rest : rests) {
    std::array<double, 2> place{};
    int count = 0;
    for (const PlotRun::Sample& sample : *samples) {
      if (sample.time_s <= rest.end_s - kRestWindow_s || sample.time_s > rest.end_s) continue;
      place[0] += sample.tip_m[0];
      place[1] += sample.tip_m[1];
      ++count;
    }
    if (count == 0) continue;
    for (PlotRun::Sample& sample : *samples) {
      if (sample.time_s < from_s || sample.time_s > rest.end_s) continue;
      sample.from_rest_mm =
          1e3 * std::hypot(sample.tip_m[0] - place[0] / count, sample.tip_m[1] - place[1] / count);
    }
    from_s = rest.end_s;
  }
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

// Draws the arm from the estimated hub angles and modal coordinates.
class Skeleton {
 public:
  Skeleton(const ArmParameters& arm, const StateLayout& layout)
      : layout_(layout), link1_(Link1Modes(arm, 2)), link2_(Link2Modes(arm, 2)) {}

  std::vector<std::array<double, 2>> Points(const std::array<double, kMaxNominalStates>& x) const {
    std::vector<std::array<double, 2>> points;
    const std::array<double, 2> f1 = Modes(x, 0), f2 = Modes(x, 1);
    const double hub1 = x[static_cast<std::size_t>(layout_.hub(0))];
    const double hub2 = x[static_cast<std::size_t>(layout_.hub(1))];
    Append(link1_, {0, 0}, hub1, f1, &points);
    const double slope = link1_.slope_tip(0) * f1[0] + link1_.slope_tip(1) * f1[1];
    Append(link2_, points.back(), hub1 + std::atan(slope) + hub2, f2, &points);
    return points;
  }

 private:
  std::array<double, 2> Modes(const std::array<double, kMaxNominalStates>& x, int link) const {
    std::array<double, 2> f{};  // a mode that the model does not have is zero
    for (int mode = 0; mode < layout_.modes_per_link; ++mode) {
      f[static_cast<std::size_t>(mode)] = x[static_cast<std::size_t>(layout_.mode(link, mode))];
    }
    return f;
  }

  static void Append(const LinkModes& link, std::array<double, 2> root, double angle,
                     const std::array<double, 2>& f, std::vector<std::array<double, 2>>* points) {
    for (int i = 0; i <= kPointsPerLink; ++i) {
      const double u = link.length_m * i / kPointsPerLink;
      const double w = f[0] * link.mode[0].Value(u) + f[1] * link.mode[1].Value(u);
      points->push_back({root[0] + std::cos(angle) * u - std::sin(angle) * w,
                         root[1] + std::sin(angle) * u + std::cos(angle) * w});
    }
  }

  StateLayout layout_;
  LinkModes link1_, link2_;
};

std::vector<PlotRun::Pose> PosesOf(const LoadedRun& run, std::int64_t zero_ns) {
  std::vector<PlotRun::Pose> poses;
  const Skeleton skeleton(run.config.arm, run.config.controller.nominal);
  double next_s = -std::numeric_limits<double>::infinity();
  for (const TickRecord& record : run.contents.tick) {
    const double time_s = static_cast<double>(record.input.sampling_instant_ns - zero_ns) * 1e-9;
    if (!IsRunning(record) || time_s < next_s) continue;
    next_s = time_s + kPoseEvery_s - run.period_s() / 2;
    poses.push_back({.time_s = time_s, .point_m = skeleton.Points(record.output.x_hat)});
  }
  return poses;
}

std::vector<PlotRun::Act> ActsOf(const LoadedRun& run, double running_end_s) {
  std::vector<PlotRun::Act> acts;
  if (run.experiment) {
    for (const Motion& move : run.experiment->Motions()) {
      if (move.start_s >= running_end_s) break;
      if (!acts.empty()) acts.back().until_s = move.start_s;
      acts.push_back({.from_s = move.start_s, .until_s = running_end_s});
    }
  }
  if (acts.empty()) acts.push_back({.from_s = 0, .until_s = std::max(running_end_s, 0.1)});
  return acts;
}

}  // namespace

PlotRun PlotDataOf(const LoadedRun& run) {
  const auto& ticks = run.contents.tick;
  const bool truth =
      !ticks.empty() &&
      std::all_of(ticks.begin(), ticks.end(), [](const auto& tick) { return tick.truth.known; });
  const std::int64_t zero_ns = TimeZero_ns(run);
  const TipGeometry geometry = TipGeometryOf(run.config.arm, run.config.controller.nominal);
  const std::optional<SafetyRecord> trip = TripOf(run.contents.safety);
  PlotRun plot{.name = run.file.stem().string(),
               .period_s = run.period_s(),
               .truth = truth,
               .trip = trip ? ToString(trip->after.cause) : "",
               .sample = {},
               .span = StateSpansOf(run, zero_ns),
               .pose = PosesOf(run, zero_ns),
               .act = {},
               .metrics = MetricsOf(run)};
  double running_end_s = 0;
  for (const TickRecord& record : ticks) {
    const double time_s = static_cast<double>(record.input.sampling_instant_ns - zero_ns) * 1e-9;
    plot.sample.push_back(SampleOf(record, time_s, truth, geometry));
    if (IsRunning(record)) running_end_s = time_s;
  }
  plot.act = ActsOf(run, running_end_s);
  if (run.experiment) {
    FillDistanceFromRest(RestsOf(*run.experiment, running_end_s), &plot.sample);
  }
  return plot;
}

}  // namespace flexarm
