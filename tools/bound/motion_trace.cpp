#include "tools/bound/motion_trace.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace flexarm {
namespace {

using Quantity = Eigen::Vector2d TracePoint::*;

void AddIfReached(const MotionTrace& trace, Quantity quantity, const char* key,
                  const std::array<double, 2>& limit, std::vector<BindingLimit>* found) {
  for (std::size_t i = 0; i < 2; ++i) {
    BindingLimit binding{
        .key = key, .index = static_cast<int>(i) + 1, .largest = 0.0, .time_share = 0.0};
    for (std::size_t k = 0; k < trace.size(); ++k) {
      const double share = std::fabs((trace[k].*quantity)[static_cast<Eigen::Index>(i)]) / limit[i];
      binding.largest = std::max(binding.largest, share);
      if (k == 0 || share < kBindingShare) continue;
      binding.time_share += (trace[k].time_s - trace[k - 1].time_s) / trace.back().time_s;
    }
    if (binding.largest >= kBindingShare) found->push_back(binding);
  }
}

}  // namespace

Eigen::Vector2d RigidStrain(const Eigen::Vector2d& torque_nm, const BoundLimits& limits) {
  return {torque_nm[0] / limits.root_moment_nm[0] * limits.strain[0],
          torque_nm[1] / limits.root_moment_nm[1] * limits.strain[1]};
}

std::vector<BindingLimit> BindingLimits(const MotionTrace& trace, const BoundLimits& limits) {
  std::vector<BindingLimit> found;
  AddIfReached(trace, &TracePoint::torque_nm, "limits.torque_limit_nm", limits.torque_nm, &found);
  AddIfReached(trace, &TracePoint::strain, "limits.strain_limit", limits.strain, &found);
  AddIfReached(trace, &TracePoint::rate_rad_s, "limits.hub_rate_rad_s", limits.hub_rate_rad_s,
               &found);
  AddIfReached(trace, &TracePoint::angle_rad, "limits.soft_angle_deg", limits.hub_angle_rad,
               &found);
  std::stable_sort(found.begin(), found.end(), [](const BindingLimit& x, const BindingLimit& y) {
    return x.time_share > y.time_share;
  });
  return found;
}

}  // namespace flexarm
