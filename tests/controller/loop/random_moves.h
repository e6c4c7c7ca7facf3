#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "controller/law/experiment.h"
#include "model/rigid_joint_arm.h"

// Moves that nothing was tuned on, by the recipe of beyond.md section 4.

namespace flexarm {

/// Random numbers that are the same with every standard library.
class UniformNumbers {
 public:
  explicit UniformNumbers(std::uint64_t seed) : random_(seed) {}

  double Between(double low, double high) {
    return low + (high - low) * std::ldexp(static_cast<double>(random_() >> 11), -53);
  }

 private:
  std::mt19937_64 random_;
};

inline constexpr double kPeriodOfMoves_s = 0.02;

/// The next instant on the sampling grid.
inline double OnMoveGrid(double time_s) {
  return kPeriodOfMoves_s * std::ceil(time_s / kPeriodOfMoves_s);
}

/// What the recipe needs of a rig: it turns the elbow by 90 degrees, the shipped soft limit, which
/// heavy arms overshoot.
inline const std::vector<std::string> kWideRig = {"limits.soft_angle_deg=[110, 110]",
                                                  "sim.switch_angle_deg=[115, 115]"};

/// The study's shortest duration of a septic move (beyond.md 2.1), s: for 9 and 3.8 N m and 4 and
/// 6 rad/s, with `heaviest_kg` at the tip.
inline double RuleDuration_s(const RigidJointArm& arm, double heaviest_kg,
                             const Eigen::Vector2d& from_rad, const Eigen::Vector2d& to_rad) {
  constexpr double kPeakAcceleration = 7.51, kPeakRate = 2.19, kShortest_s = 0.4;
  const Eigen::Vector2d torque_nm(9.0, 3.8), rate_rad_s(4.0, 6.0), by = to_rad - from_rad;
  double duration_s = kShortest_s;
  for (int i = 0; i < 2; ++i) {
    duration_s = std::max(duration_s, kPeakRate * std::fabs(by[i]) / rate_rad_s[i]);
  }
  for (int point = 0; point < 5; ++point) {
    RigidJointArm::Vector q = RigidJointArm::Vector::Zero();
    q[1] = from_rad[1] + by[1] * point / 4.0;
    const Eigen::Vector2d effort =
        arm.At(arm.Outboard(heaviest_kg), q, RigidJointArm::Vector::Zero())
            .M.topLeftCorner<2, 2>() *
        by;
    for (int i = 0; i < 2; ++i) {
      duration_s =
          std::max(duration_s, std::sqrt(kPeakAcceleration * std::fabs(effort[i]) / torque_nm[i]));
    }
  }
  return duration_s;
}

/// A run of the recipe: four moves to anywhere in +-60, +-90 deg, each 1 to 1.5 times the rule for
/// 1 kg, with 1.5 s of rest after each; and the payload, anything from 0 to `heaviest_kg`.
struct RandomMoves {
  Experiment experiment;
  double payload_kg;
};

inline RandomMoves MakeRandomMoves(const RigidJointArm& arm, std::uint64_t seed, double heaviest_kg,
                                   int moves = 4) {
  constexpr double kRest_s = 1.5;
  UniformNumbers random(seed);
  RandomMoves out{};
  out.payload_kg = random.Between(0.0, heaviest_kg);
  out.experiment.name = "random-moves";
  Eigen::Vector2d from_deg = Eigen::Vector2d::Zero();
  double now_s = 0.0;
  for (int i = 0; i < moves; ++i) {
    const Eigen::Vector2d to_deg(random.Between(-60.0, 60.0), random.Between(-90.0, 90.0));
    const double rad = std::numbers::pi / 180.0;
    const double rule_s = RuleDuration_s(arm, 1.0, from_deg * rad, to_deg * rad);
    Move move{.start_s = now_s, .to_deg = {to_deg[0], to_deg[1]}, .profile = MoveProfile::kSeptic};
    move.duration_s = OnMoveGrid(rule_s * random.Between(1.0, 1.5));
    out.experiment.move.push_back(move);
    now_s = OnMoveGrid(now_s + *move.duration_s + kRest_s);
    from_deg = to_deg;
  }
  out.experiment.duration_s = now_s;
  return out;
}

}  // namespace flexarm
