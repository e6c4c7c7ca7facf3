#include "tools/bound/rigid_straight.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "tools/bound/path_speed.h"
#include "tools/bound/rigid_arm.h"

namespace flexarm {
namespace {

constexpr double kStep = 1.0 / kPathPieces;

double LargestSpeedSquared(const Eigen::Vector2d& way_rad, const BoundLimits& limits) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 2; ++i) {
    const double way = std::fabs(way_rad[static_cast<Eigen::Index>(i)]);
    if (way > 0.0) least = std::min(least, limits.hub_rate_rad_s[i] / way);
  }
  return least * least;
}

std::vector<PathPiece> PiecesOf(const RigidJointArm& arm, const BoundLimits& limits,
                                const RestMove& move) {
  const Eigen::Vector2d way_rad = move.to_rad - move.from_rad;
  const OutboardBody body = arm.Outboard(move.payload_kg);
  const double largest = LargestSpeedSquared(way_rad, limits);
  std::vector<PathPiece> pieces;
  pieces.reserve(kPathPieces);
  for (int k = 0; k < kPathPieces; ++k) {
    const Eigen::Vector2d angle_rad = move.from_rad + (k + 0.5) * kStep * way_rad;
    const RigidForces forces = RigidForcesAt(arm, body, angle_rad, way_rad);
    pieces.push_back({.a = forces.M * way_rad, .b = forces.bias, .largest_speed_squared = largest});
  }
  return pieces;
}

}  // namespace

double RigidStraight_s(const RigidJointArm& arm, const BoundLimits& limits, const RestMove& move) {
  const std::vector<PathPiece> pieces = PiecesOf(arm, limits, move);
  return TimesOver(FastestSquaredSpeeds(pieces, kStep, limits.rigid_torque_nm()), kStep).back();
}

MotionTrace RigidStraightMotion(const RigidJointArm& arm, const BoundLimits& limits,
                                const RestMove& move) {
  const std::vector<PathPiece> pieces = PiecesOf(arm, limits, move);
  const std::vector<double> z = FastestSquaredSpeeds(pieces, kStep, limits.rigid_torque_nm());
  const std::vector<double> time_s = TimesOver(z, kStep);
  const Eigen::Vector2d way_rad = move.to_rad - move.from_rad;
  MotionTrace trace;
  for (std::size_t k = 0; k < z.size(); ++k) {
    // At the very end the torque of the last piece still holds.
    const std::size_t piece = std::min(k, pieces.size() - 1);
    const double acceleration = (z[piece + 1] - z[piece]) / (2.0 * kStep);
    const double middle_z = 0.5 * (z[piece] + z[piece + 1]);
    const Eigen::Vector2d torque_nm = pieces[piece].a * acceleration + pieces[piece].b * middle_z;
    trace.push_back({.time_s = time_s[k],
                     .angle_rad = move.from_rad + static_cast<double>(k) * kStep * way_rad,
                     .rate_rad_s = std::sqrt(z[k]) * way_rad,
                     .torque_nm = torque_nm,
                     .strain = RigidStrain(torque_nm, limits)});
  }
  return trace;
}

}  // namespace flexarm
