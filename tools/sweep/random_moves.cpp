#include "tools/sweep/random_moves.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "config/derivation/arm_scales.h"
#include "config/thesis_arm.h"
#include "config/tuning_basis.h"
#include "model/units.h"

namespace flexarm {
namespace {

constexpr double kShareOfSoftAngle = 2.0 / 3.0;

// The next multiple of the period.
double GridOf_s(double period_s) { return period_s * std::ceil(kMoveGrid_s / period_s - 1e-9); }

}  // namespace

// 53 bits of the generator: std::uniform_real_distribution may differ between libraries.
double UniformNumbers::Between(double low, double high) {
  return low + (high - low) * std::ldexp(static_cast<double>(random_() >> 11), -53);
}

double OnMoveGrid(double time_s, double grid_s) { return grid_s * std::ceil(time_s / grid_s); }

double RuleDuration_s(const RigidJointArm& arm, double heaviest_kg, const Eigen::Vector2d& from_rad,
                      const Eigen::Vector2d& to_rad, const MoveAbility& ability) {
  constexpr double kPeakAcceleration = 7.51, kPeakRate = 2.19, kShortest_s = 0.4;
  const Eigen::Vector2d by = to_rad - from_rad;
  double duration_s = kShortest_s;
  for (int i = 0; i < 2; ++i) {
    const double rate_rad_s = ability.rate_rad_s[static_cast<std::size_t>(i)];
    duration_s = std::max(duration_s, kPeakRate * std::fabs(by[i]) / rate_rad_s);
  }
  for (int point = 0; point < 5; ++point) {
    RigidJointArm::Vector q = RigidJointArm::Vector::Zero();
    q[1] = from_rad[1] + by[1] * point / 4.0;
    const Eigen::Vector2d effort =
        arm.At(arm.Outboard(heaviest_kg), q, RigidJointArm::Vector::Zero())
            .M.topLeftCorner<2, 2>() *
        by;
    for (int i = 0; i < 2; ++i) {
      const double torque_nm = ability.torque_nm[static_cast<std::size_t>(i)];
      duration_s =
          std::max(duration_s, std::sqrt(kPeakAcceleration * std::fabs(effort[i]) / torque_nm));
    }
  }
  return duration_s;
}

MoveRecipe RecipeFor(const RigConfig& config) {
  MoveRecipe recipe;
  recipe.payload_kg = config.controller.payload_range_kg;
  recipe.rule_for_kg = recipe.payload_kg[1];
  recipe.grid_s = GridOf_s(config.loop.period_s());
  if (IsThesisArm(config.arm)) return recipe;
  const ArmScales scales = ScalesOf(TuningBasisOf(config));
  const SafetyConfig& safety = config.safety;
  for (std::size_t i = 0; i < 2; ++i) {
    recipe.within_deg[i] =
        std::min(recipe.within_deg[i], kShareOfSoftAngle * safety.soft_angle_deg[i]);
    recipe.ability.torque_nm[i] = safety.plan_fraction * scales.torque_nm[i];
    recipe.ability.rate_rad_s[i] = safety.plan_fraction * safety.hub_rate_rad_s[i];
  }
  return recipe;
}

std::array<double, 2> RandomTarget_deg(const MoveRecipe& recipe, UniformNumbers* random) {
  const double to2_deg = random->Between(-recipe.within_deg[1], recipe.within_deg[1]);
  return {random->Between(-recipe.within_deg[0], recipe.within_deg[0]), to2_deg};
}

RandomMoves MakeRandomMoves(const RigidJointArm& arm, std::uint64_t seed, double heaviest_kg,
                            int moves) {
  return MakeRandomMoves(arm, seed, MoveRecipe{.payload_kg = {0.0, heaviest_kg}}, moves);
}

RandomMoves MakeRandomMoves(const RigidJointArm& arm, std::uint64_t seed, const MoveRecipe& recipe,
                            int moves) {
  UniformNumbers random(seed);
  RandomMoves out{};
  out.payload_kg = random.Between(recipe.payload_kg[0], recipe.payload_kg[1]);
  out.experiment.name = "random-moves";
  Eigen::Vector2d from_deg = Eigen::Vector2d::Zero();
  double now_s = 0.0;
  for (int i = 0; i < moves; ++i) {
    const std::array<double, 2> target_deg = RandomTarget_deg(recipe, &random);
    const Eigen::Vector2d to_deg(target_deg[0], target_deg[1]);
    const double rule_s = RuleDuration_s(arm, recipe.rule_for_kg, from_deg * kRadPerDeg,
                                         to_deg * kRadPerDeg, recipe.ability);
    Move move{.start_s = now_s, .to_deg = target_deg, .profile = MoveProfile::kSeptic};
    move.duration_s = OnMoveGrid(rule_s * random.Between(1.0, 1.5), recipe.grid_s);
    out.experiment.move.push_back(move);
    now_s = OnMoveGrid(now_s + *move.duration_s + kRandomMovesRest_s, recipe.grid_s);
    from_deg = to_deg;
  }
  out.experiment.duration_s = now_s;
  return out;
}

}  // namespace flexarm
