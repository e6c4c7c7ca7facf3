#pragma once

#include <string>

#include "controller/law/design.h"
#include "controller/reference/motion_limits.h"
#include "controller/reference/reference.h"
#include "controller/types/experiment.h"

// Changes of a path while it is followed (docs/experiments.md, "While it runs"): each is computed
// and checked against every limit, for every payload, before it is asked for. Not real-time safe.

namespace flexarm {

/// @returns why the path of this run cannot be changed; "": it can
std::string WhyNoChange(const ReferenceTable& table);

/// First sample at which the path may change for a command that is known at `sample`, when the
/// next is to be granted `ahead` samples later: the speed must be constant.
int FirstChange(const ReferenceTable& table, int sample, int ahead) noexcept;

/// The same path at another speed from the start on. @param speed  share of the planned one, > 0
/// @throws RejectedError as the functions below
ReferenceTable AtSpeed(const ReferenceTable& table, double speed, const Design& design,
                       const MotionLimits& limits);

/// The same path at another speed, 0 to 1 times the planned one: 0 is a pause. The speed changes as
/// fast as the limits allow, within 1 to 5 s.
/// @param from  FirstChange
/// @throws RejectedError if the path cannot be changed, no such change keeps the limits, or the run
///         would be too long
ReferenceTable WithSpeed(const ReferenceTable& table, int from, double speed, const Design& design,
                         const MotionLimits& limits);

/// Another goal: from `from` on the arm goes there, and rests for kRestAfterRows_s; the rest of the
/// experiment is dropped. The speed stays; at rest the arm begins when it is resumed.
/// @param goal  without duration_s: the shortest within limits.plan_fraction at the planned speed
/// @throws RejectedError as above, or if the goal is beyond a limit or out of reach
ReferenceTable Retargeted(const ReferenceTable& table, int from, const Move& goal,
                          const Design& design, const MotionLimits& limits);

}  // namespace flexarm
