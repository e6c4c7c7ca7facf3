#include "tools/sweep/random_moves.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "model/units.h"

namespace flexarm {
namespace {

constexpr double kRuleFor_kg = 1.0;

}  // namespace

// 53 bits of the generator: std::uniform_real_distribution may differ between libraries.
double UniformNumbers::Between(double low, double high) {
  return low + (high - low) * std::ldexp(static_cast<double>(random_() >> 11), -53);
}

double OnMoveGrid(double time_s) { return kMoveGrid_s * std::ceil(time_s / kMoveGrid_s); }

double RuleDuration_s(const RigidJointArm& arm, double heaviest_kg, const Eigen::Vector2d& from_rad,
                      const Eigen::Vector2d& to_rad) {
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

RandomMoves MakeRandomMoves(const RigidJointArm& arm, std::uint64_t seed, double heaviest_kg,
                            int moves) {
  UniformNumbers random(seed);
  RandomMoves out{};
  out.payload_kg = random.Between(0.0, heaviest_kg);
  out.experiment.name = "random-moves";
  Eigen::Vector2d from_deg = Eigen::Vector2d::Zero();
  double now_s = 0.0;
  for (int i = 0; i < moves; ++i) {
    const double to2_deg = random.Between(-90.0, 90.0), to1_deg = random.Between(-60.0, 60.0);
    const Eigen::Vector2d to_deg(to1_deg, to2_deg);
    const double rule_s =
        RuleDuration_s(arm, kRuleFor_kg, from_deg * kRadPerDeg, to_deg * kRadPerDeg);
    Move move{.start_s = now_s, .to_deg = {to1_deg, to2_deg}, .profile = MoveProfile::kSeptic};
    move.duration_s = OnMoveGrid(rule_s * random.Between(1.0, 1.5));
    out.experiment.move.push_back(move);
    now_s = OnMoveGrid(now_s + *move.duration_s + kRandomMovesRest_s);
    from_deg = to_deg;
  }
  out.experiment.duration_s = now_s;
  return out;
}

}  // namespace flexarm
