#include <cmath>
#include <vector>

#include "model/beam/link_modes.h"
#include "tools/plot/plot_data.h"
#include "tools/plot/run_marks.h"

namespace flexarm {
namespace {

// The arm by the estimated hub angles and modal coordinates.
class Skeleton {
 public:
  Skeleton(const ArmParameters& arm, const StateLayout& layout, int points_per_link)
      : layout_(layout),
        points_per_link_(points_per_link),
        link1_(Link1Modes(arm, 2)),
        link2_(Link2Modes(arm, 2)) {}

  std::vector<std::array<double, 2>> Points(const std::array<double, kMaxNominalStates>& x) const {
    std::vector<std::array<double, 2>> points;
    const std::array<double, 2> f1 = Modes(x, 0), f2 = Modes(x, 1);
    const double hub1 = x[static_cast<std::size_t>(layout_.hub(0))];
    const double hub2 = x[static_cast<std::size_t>(layout_.hub(1))];
    points.push_back({0.0, 0.0});
    Append(link1_, {0.0, 0.0}, hub1, f1, &points);
    const double slope = link1_.slope_tip(0) * f1[0] + link1_.slope_tip(1) * f1[1];
    const std::array<double, 2> elbow = points.back();
    Append(link2_, elbow, hub1 + std::atan(slope) + hub2, f2, &points);
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

  void Append(const LinkModes& link, const std::array<double, 2>& root, double angle,
              const std::array<double, 2>& f, std::vector<std::array<double, 2>>* points) const {
    for (int i = 1; i <= points_per_link_; ++i) {
      const double u = link.length_m * i / points_per_link_;
      const double w = f[0] * link.mode[0].Value(u) + f[1] * link.mode[1].Value(u);
      points->push_back({root[0] + std::cos(angle) * u - std::sin(angle) * w,
                         root[1] + std::sin(angle) * u + std::cos(angle) * w});
    }
  }

  StateLayout layout_;
  int points_per_link_;
  LinkModes link1_, link2_;
};

}  // namespace

std::vector<PlotRun::Pose> PosesOf(const LoadedRun& run, double from_s, double until_s,
                                   std::size_t most, int points_per_link) {
  const Skeleton skeleton(run.config.arm, run.config.controller.nominal, points_per_link);
  const std::int64_t zero_ns = TimeZero_ns(run);
  std::vector<std::pair<double, const TickRecord*>> shown;
  for (const TickRecord& record : run.contents.tick) {
    const double time_s = static_cast<double>(record.input.sampling_instant_ns - zero_ns) * 1e-9;
    const bool running = record.input.safety_state == SafetyState::kRunning;
    if (running && time_s >= from_s && time_s <= until_s) shown.emplace_back(time_s, &record);
  }
  std::vector<PlotRun::Pose> poses;
  const std::size_t count = std::min(most, shown.size());
  for (std::size_t i = 0; i < count; ++i) {
    const auto& [time_s, record] = shown[count == 1 ? 0 : i * (shown.size() - 1) / (count - 1)];
    poses.push_back({.time_s = time_s, .point_m = skeleton.Points(record->output.x_hat)});
  }
  return poses;
}

}  // namespace flexarm
