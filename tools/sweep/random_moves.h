#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "controller/types/experiment.h"
#include "model/rigid_joint/rigid_joint_arm.h"

namespace flexarm {

/// Random numbers that are the same everywhere: the generator's bits are standardised, and what is
/// made of them is made here.
class UniformNumbers {
 public:
  explicit UniformNumbers(std::uint64_t seed) : random_(seed) {}
  double Between(double low, double high);

 private:
  std::mt19937_64 random_;
};

/// What the recipe asks of a rig: it turns the elbow by 90 degrees, the shipped soft limit, which
/// heavy arms overshoot. As --set takes it.
inline const std::vector<std::string> kWideRig = {"limits.soft_angle_deg=[110, 110]",
                                                  "sim.switch_angle_deg=[115, 115]"};

inline constexpr double kMoveGrid_s = 0.02;  ///< random moves begin and end on samples

/// The next instant on that grid.
double OnMoveGrid(double time_s);

inline constexpr double kRandomMovesRest_s = 1.5;  ///< after each of MakeRandomMoves

/// The design study's shortest duration of a septic move, s: for 9 and 3.8 N m and 4 and 6 rad/s,
/// with `heaviest_kg` at the tip. Source: docs/theory/payload.md 3.1.
/// @param from_rad,to_rad  both joints, in the rigid coordinate
double RuleDuration_s(const RigidJointArm& arm, double heaviest_kg, const Eigen::Vector2d& from_rad,
                      const Eigen::Vector2d& to_rad);

/// Moves that nothing was tuned on, and what they are made with.
struct RandomMoves {
  Experiment experiment;
  double payload_kg;
};

/// A run of the design study's recipe: moves to anywhere in +-60, +-90 deg, each 1 to 1.5 times the
/// rule for 1 kg, with 1.5 s of rest after each; and the payload, anything from 0 to
/// `heaviest_kg`. Source: docs/theory/payload.md 6.1, where a run has four moves.
RandomMoves MakeRandomMoves(const RigidJointArm& arm, std::uint64_t seed, double heaviest_kg,
                            int moves = 4);

}  // namespace flexarm
