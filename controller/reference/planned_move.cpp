#include "controller/reference/planned_move.h"

#include "controller/reference/retarget.h"

namespace flexarm {

Eigen::Vector2d TorqueOf(const PlannedMove& move, const Design& design) {
  const auto& from_rad = move.from.angle_rad;
  return design.rigid_inertia_kgm2 *
         Eigen::Vector2d(move.to_rad[0] - from_rad[0], move.to_rad[1] - from_rad[1]);
}

RigidPoint PlannedMove::At(double sample, double period_s) const noexcept {
  if (retargets) {
    return SepticToRest(from, to_rad, periods * period_s, (sample - first) * period_s);
  }
  const double begins = is_shortest ? first : first + 0.5;
  const double takes = is_shortest ? periods : periods - 1;
  const double T = takes * period_s;
  const ProfilePoint point = ProfileAt(profile, (sample - begins) / takes);
  RigidPoint out{};
  for (std::size_t i = 0; i < 2; ++i) {
    const double by_rad = to_rad[i] - from.angle_rad[i];
    out.angle_rad[i] = from.angle_rad[i] + by_rad * point.s;
    out.rate_rad_s[i] = by_rad * point.ds / T;
    out.acceleration_rad_s2[i] = by_rad * point.dds / (T * T);
    out.jerk_rad_s3[i] = by_rad * point.ddds / (T * T * T);
  }
  return out;
}

}  // namespace flexarm
