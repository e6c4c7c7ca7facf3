#pragma once

#include "model/rigid_joint/rigid_joint_arm.h"
#include "tools/bound/bound_limits.h"
#include "tools/bound/motion_trace.h"
#include "tools/bound/rest_move.h"

namespace flexarm {

inline constexpr int kPathPieces =
    1000;  ///< of the path's grid; the time changes by 1e-5 with 2000

/// Shortest time of a rigid arm over the straight line in joint space, s; for tables. A few
/// hundred microseconds.
///
/// Y = from + (to - from) s: time-optimal path parametrisation (path_speed.h) with the torques of
/// BoundLimits::rigid_torque_nm and the hubs' rates. Without friction.
/// Source: docs/theory/bound.md 2.
/// @param move  not at rest all the time
double RigidStraight_s(const RigidJointArm& arm, const BoundLimits& limits, const RestMove& move);

/// The motion of RigidStraight_s; its last instant is the time.
MotionTrace RigidStraightMotion(const RigidJointArm& arm, const BoundLimits& limits,
                                const RestMove& move);

}  // namespace flexarm
