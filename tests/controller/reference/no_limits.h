#pragma once

#include "tests/controller/law/shipped_rig.h"

namespace flexarm {

/// The shipped arm with limits that are never reached: a test lowers the limits that it checks.
inline MotionLimits NoLimits() {
  MotionLimits limits = ShippedLimits();
  for (auto* limit : {&limits.soft_angle_rad, &limits.torque_nm, &limits.slew_nm_per_s,
                      &limits.hub_rate_rad_s, &limits.strain}) {
    limit->fill(1e6);
  }
  return limits;
}

}  // namespace flexarm
