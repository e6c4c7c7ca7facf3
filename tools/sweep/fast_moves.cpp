#include "tools/sweep/fast_moves.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "model/units.h"
#include "tools/bound/rigid_straight.h"

namespace flexarm {
namespace {

constexpr double kSpacing = 3.0;  // the slowest laws take 2.6 times the bound
constexpr double kNoRatio = std::numeric_limits<double>::quiet_NaN();

Eigen::Vector2d Radians(const std::array<double, 2>& deg) {
  return {RadFromDeg(deg[0]), RadFromDeg(deg[1])};
}

bool IsFast(const Experiment& experiment) {
  return !experiment.move.empty() && experiment.Motions().size() == experiment.move.size() &&
         std::all_of(experiment.move.begin(), experiment.move.end(),
                     [](const Move& move) { return move.shortest && !move.to_tip_m; });
}

// The mean of times over bounds; NaN: none, or one of the times is missing.
double MeanRatio(std::span<const Arrival> arrivals, std::span<const double> bounds_s,
                 std::optional<double> Arrival::* time_s) {
  if (arrivals.empty()) return kNoRatio;
  double sum = 0.0;
  for (std::size_t i = 0; i < arrivals.size(); ++i)
    sum += (arrivals[i].*time_s).value_or(kNoRatio) / bounds_s[i];
  return sum / static_cast<double>(arrivals.size());
}

}  // namespace

RandomMoves MakeFastMoves(const RigConfig& config, std::uint64_t seed, const MoveRecipe& recipe,
                          int moves) {
  const RigidJointArm arm(config.arm);
  const BoundLimits limits = BoundLimitsOf(config, PlanTorqueShare(config));
  UniformNumbers random(seed);
  RandomMoves out{};
  out.payload_kg = random.Between(recipe.payload_kg[0], recipe.payload_kg[1]);
  out.experiment.name = "fast-moves";
  Eigen::Vector2d from_rad = Eigen::Vector2d::Zero();
  double now_s = 0.0;
  for (int i = 0; i < moves; ++i) {
    out.experiment.move.push_back({.start_s = now_s,
                                   .shortest = true,
                                   .same_load = i > 0,
                                   .to_deg = RandomTarget_deg(recipe, &random)});
    const Eigen::Vector2d to_rad = Radians(out.experiment.move.back().to_deg);
    double bound_s = 0.0;
    for (const double payload_kg : config.controller.payload_range_kg)
      bound_s = std::max(bound_s, RigidStraight_s(arm, limits, {from_rad, to_rad, payload_kg}));
    const double least_s =
        config.controller.payload ? config.controller.payload->fast_least_s : 0.0;
    now_s = OnMoveGrid(now_s + std::max(least_s, kSpacing * bound_s) + kRandomMovesRest_s,
                       recipe.grid_s);
    from_rad = to_rad;
  }
  out.experiment.duration_s = now_s;
  return out;
}

BoundRatios RatiosOf(const SimulationRequest& request, const RunMetrics& metrics) {
  const std::vector<Move>& moves = request.experiment.move;
  if (!IsFast(request.experiment) || metrics.arrival.size() != moves.size())
    return {kNoRatio, kNoRatio, kNoRatio, kNoRatio};
  const RigConfig& plant = request.plant ? *request.plant : request.config;
  const double payload_kg = request.payload_kg.value_or(plant.arm.payload_mass_kg);
  const RigidJointArm arm(request.config.arm);
  const BoundLimits limits = BoundLimitsOf(request.config, PlanTorqueShare(request.config));
  Eigen::Vector2d from_rad(request.start_rad[0], request.start_rad[1]);
  std::vector<double> bounds_s;
  for (const Move& move : moves) {
    const Eigen::Vector2d to_rad = Radians(move.to_deg);
    bounds_s.push_back(from_rad == to_rad
                           ? kNoRatio
                           : RigidStraight_s(arm, limits, {from_rad, to_rad, payload_kg}));
    from_rad = to_rad;
  }
  const std::span<const Arrival> arrivals(metrics.arrival);
  const std::span<const double> bounds(bounds_s);
  return {
      .first_at_rest = MeanRatio(arrivals.first(1), bounds, &Arrival::at_rest_s),
      .later_at_rest = MeanRatio(arrivals.subspan(1), bounds.subspan(1), &Arrival::at_rest_s),
      .first_on_target = MeanRatio(arrivals.first(1), bounds, &Arrival::on_target_s),
      .later_on_target = MeanRatio(arrivals.subspan(1), bounds.subspan(1), &Arrival::on_target_s)};
}

}  // namespace flexarm
