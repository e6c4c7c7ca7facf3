#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "controller/types/experiment.h"
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

/// Overrides of a rig for random moves, in the form of --set: the elbow turns to 90 degrees, the
/// shipped soft limit, and heavy arms overshoot it.
inline const std::vector<std::string> kWideRig = {"limits.soft_angle_deg=[110, 110]",
                                                  "sim.switch_angle_deg=[115, 115]"};

inline constexpr double kMoveGrid_s = 0.02;  ///< random moves begin and end on samples

/// The next instant on the grid of kMoveGrid_s.
double OnMoveGrid(double time_s);

inline constexpr double kRandomMovesRest_s = 1.5;  ///< after each of MakeRandomMoves

/// The design study's shortest duration of a septic move, s: for 9 and 3.8 N m and 4 and 6 rad/s,
/// with `heaviest_kg` at the tip. Source: docs/theory/payload.md 3.1.
/// @param from_rad,to_rad  both joints, in the rigid coordinate
double RuleDuration_s(const RigidJointArm& arm, double heaviest_kg, const Eigen::Vector2d& from_rad,
                      const Eigen::Vector2d& to_rad);

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

}  // namespace flexarm
