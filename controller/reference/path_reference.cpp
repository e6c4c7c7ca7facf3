#include "controller/reference/path_reference.h"

#include <algorithm>
#include <cstddef>

#include "model/rigid_joint/rigid_joint_step.h"

namespace flexarm {

RigidPath::RigidPath(std::span<const PlannedMove> moves, const std::array<double, 2>& start_rad,
                     int periods, double period_s) {
  point_.resize(
      static_cast<std::size_t>(periods) + 1,
      {.angle_rad = start_rad, .rate_rad_s = {}, .acceleration_rad_s2 = {}, .jerk_rad_s3 = {}});
  for (std::size_t i = 0; i < moves.size(); ++i) {
    const int until = i + 1 < moves.size() ? std::min(periods, moves[i + 1].first - 1) : periods;
    for (int k = std::max(moves[i].first, 0); k <= until; ++k) {
      point_[static_cast<std::size_t>(k)] = moves[i].At(k, period_s);
    }
  }
}

const RigidPoint& RigidPath::At(int k) const noexcept {
  return point_[static_cast<std::size_t>(std::clamp(k, 0, periods()))];
}

ReferenceSample QuasiStaticSample(const RigidJointArm& arm, double payload_kg,
                                  const std::array<RigidPoint, 3>& path, double period_s) noexcept {
  const MotionSample bent = QuasiStaticOver(arm, payload_kg, path, period_s);
  ReferenceSample sample{};
  std::copy(bent.x.begin(), bent.x.end(), sample.x_m.begin());
  sample.u_m_nm = bent.torque_nm;
  return sample;
}

std::vector<ReferenceSample> QuasiStaticReference(const RigidPath& path, const RigidJointArm& arm,
                                                  double payload_kg, double period_s, int first,
                                                  int last) {
  std::vector<ReferenceSample> samples(static_cast<std::size_t>(last - first) + 1);
  for (int k = first; k <= last; ++k) {
    samples[static_cast<std::size_t>(k - first)] =
        QuasiStaticSample(arm, payload_kg, path.Around(k), period_s);
  }
  return samples;
}

}  // namespace flexarm
