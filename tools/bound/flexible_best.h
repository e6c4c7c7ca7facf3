#pragma once

#include <cstddef>
#include <functional>

#include "model/rigid_joint/rigid_joint_arm.h"
#include "tools/bound/bound_limits.h"
#include "tools/bound/found_motion.h"
#include "tools/bound/rest_move.h"

namespace flexarm {

/// Fastest motion found of the arm whose links bend, from rest to rest of hubs and links.
///
/// FindFastestPlan from three starts. Torques are held for equal periods of at most about
/// `period_s`, longer ones where more than kMostFlexiblePeriods would be needed; strains, hub rates
/// and hub angles are within their limits at the end of each. Without friction. The best found is
/// an upper limit of the shortest time, not a bound. Some seconds.
/// Source: docs/theory/bound.md 4.
/// @param period_s  of the loop
FoundMotion FlexibleBestFound(const RigidJointArm& arm, const BoundLimits& limits,
                              const RestMove& move, double period_s,
                              const std::function<void()>& progress = {});

inline constexpr int kMostFlexiblePeriods = 60;
inline constexpr std::size_t kMostFlexiblePrograms = 615;  ///< of all starts, at most

}  // namespace flexarm
