#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "config/config.h"
#include "model/rigid_joint/rigid_joint_arm.h"

namespace flexarm {

/// Random numbers that are the same on every machine: the standard defines the generator's bits,
/// and this class converts them to numbers.
class UniformNumbers {
 public:
  explicit UniformNumbers(std::uint64_t seed) : random_(seed) {}
  double Between(double low, double high);

 private:
  std::mt19937_64 random_;
};

/// Overrides of the thesis's rig for random moves, in the form of --set: the elbow turns to 90
/// degrees, the shipped soft limit, and heavy arms overshoot it.
inline const std::vector<std::string> kWideRig = {"limits.soft_angle_deg=[110, 110]",
                                                  "sim.switch_angle_deg=[115, 115]"};

/// Random moves begin and end on this grid, or on the next coarser one of the loop's samples.
inline constexpr double kMoveGrid_s = 0.02;

/// The next instant on a grid.
double OnMoveGrid(double time_s, double grid_s = kMoveGrid_s);

inline constexpr double kRandomMovesRest_s = 1.5;  ///< after each of MakeRandomMoves

/// What random moves may ask of the joints; by default the design study's values for its arm.
struct MoveAbility {
  std::array<double, 2> torque_nm = {9.0, 3.8}, rate_rad_s = {4.0, 6.0};
};

/// The shortest duration of a septic move with `heaviest_kg` at the tip, s. Source:
/// docs/theory/payload.md 3.1.
/// @param from_rad,to_rad  both joints, in the rigid coordinate
double RuleDuration_s(const RigidJointArm& arm, double heaviest_kg, const Eigen::Vector2d& from_rad,
                      const Eigen::Vector2d& to_rad, const MoveAbility& ability = {});

/// From what random moves are drawn; by default the design study's recipe for the thesis's arm.
struct MoveRecipe {
  std::array<double, 2> within_deg = {60.0, 90.0};  ///< targets to either side
  std::array<double, 2> payload_kg = {0.0, 1.0};    ///< least and greatest of a run
  double rule_for_kg = 1.0;                         ///< payload that the durations allow
  MoveAbility ability{};
  double grid_s = kMoveGrid_s;
};

/// The recipe for a rig, with payloads of controller.payload_range_kg. For an arm other than the
/// thesis's the targets keep two thirds of the soft angles, and the moves need limits.plan_fraction
/// of the rate limits and of the torques that joints and links bear (ArmScales).
MoveRecipe RecipeFor(const RigConfig& config);

/// The next target of random moves: th1, th2, deg. Takes two numbers, that of th2 first.
std::array<double, 2> RandomTarget_deg(const MoveRecipe& recipe, UniformNumbers* random);

/// Moves that no law was tuned on, and the payload of the run.
struct RandomMoves {
  Experiment experiment;
  double payload_kg;
};

/// A run of the design study's recipe: moves to random targets in +-60, +-90 deg, each of 1 to 1.5
/// times the duration of the rule for 1 kg, with 1.5 s of rest after each; and a random payload
/// from 0 to `heaviest_kg`. Source: docs/theory/payload.md 6.1, where a run has four moves.
RandomMoves MakeRandomMoves(const RigidJointArm& arm, std::uint64_t seed, double heaviest_kg,
                            int moves = 4);
/// The same of any recipe.
RandomMoves MakeRandomMoves(const RigidJointArm& arm, std::uint64_t seed, const MoveRecipe& recipe,
                            int moves = 4);

}  // namespace flexarm
