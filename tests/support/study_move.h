#pragma once

#include <Eigen/Core>
#include <array>
#include <numbers>
#include <vector>

#include "controller/types/motion_profile.h"
#include "model/rigid_joint/quasi_static_map.h"

namespace flexarm {

/// A septic move from rest to rest, with the rest before and after it.
struct SepticMove {
  static constexpr double kPeriod_s = 0.02;

  Eigen::Vector2d from_rad, to_rad;
  int periods;

  /// Y, `sample` periods after its start.
  RigidPoint At(int sample) const {
    const double T = periods * kPeriod_s;
    const Eigen::Vector2d way = to_rad - from_rad;
    const ProfilePoint p = ProfileAt(MoveProfile::kSeptic, static_cast<double>(sample) / periods);
    RigidPoint point{};
    Eigen::Vector2d::Map(point.angle_rad.data()) = from_rad + way * p.s;
    Eigen::Vector2d::Map(point.rate_rad_s.data()) = way * p.ds / T;
    Eigen::Vector2d::Map(point.acceleration_rad_s2.data()) = way * p.dds / (T * T);
    return point;
  }

  /// Three points around a sample: the one before, it, and the next.
  std::array<RigidPoint, 3> Around(int sample) const {
    return {At(sample - 1), At(sample), At(sample + 1)};
  }

  /// Reference for a plan that starts at a sample: from the one before to 20 samples and one after.
  std::vector<RigidPoint> Ahead(int sample) const {
    std::vector<RigidPoint> path;
    for (int i = sample - 1; i <= periods + 21; ++i) path.push_back(At(i));
    return path;
  }
};

/// The move of beyond-golden.json: 30/30 deg from rest at 0 in 1.78 s, the shortest duration by the
/// rule of the design study with 1 kg.
inline SepticMove StudyMove() {
  return {.from_rad = Eigen::Vector2d::Zero(),
          .to_rad = Eigen::Vector2d::Constant(std::numbers::pi / 6.0),
          .periods = 89};
}

}  // namespace flexarm
