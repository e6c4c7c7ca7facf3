#pragma once

#include <array>
#include <numbers>

#include "controller/law/motion_profile.h"
#include "model/quasi_static_map.h"

namespace flexarm {

/// The move of beyond-golden.json: 30/30 deg from rest at 0, septic, the shortest that the study's
/// rule allows with 1 kg.
struct StudyMove {
  static constexpr double kPeriod_s = 0.02;
  static constexpr int kPeriods = 89;  ///< the file says 1.78 s

  /// Y, `sample` periods after its start; rest before and after.
  static RigidPathPoint At(int sample) {
    constexpr double kT = kPeriods * kPeriod_s;
    const Eigen::Vector2d way = Eigen::Vector2d::Constant(std::numbers::pi / 6.0);
    const ProfilePoint p = ProfileAt(MoveProfile::kSeptic, static_cast<double>(sample) / kPeriods);
    return {.Y = way * p.s, .Y_dot = way * p.ds / kT, .Y_ddot = way * p.dds / (kT * kT)};
  }

  static std::array<RigidPathPoint, 3> Around(int sample) {
    return {At(sample - 1), At(sample), At(sample + 1)};
  }
};

}  // namespace flexarm
