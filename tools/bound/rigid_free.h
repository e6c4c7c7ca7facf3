#pragma once

#include <functional>

#include "model/rigid_joint/rigid_joint_arm.h"
#include "tools/bound/bound_limits.h"
#include "tools/bound/found_motion.h"
#include "tools/bound/rest_move.h"

namespace flexarm {

inline constexpr int kFreePeriods = 50;  ///< of equal length, torque held

/// Fastest motion found of a rigid arm over any path: FindFastestPlan from three starts, or that of
/// the straight line if none is faster. A tenth of a second to half a second.
///
/// Torques as RigidStraight_s; hub rates and angles are within their limits after each period.
/// Source: docs/theory/bound.md 3.
FoundMotion RigidFreeMotion(const RigidJointArm& arm, const BoundLimits& limits,
                            const RestMove& move, const std::function<void()>& progress = {});

}  // namespace flexarm
