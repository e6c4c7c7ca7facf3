#pragma once

#include <cstdint>
#include <optional>

#include "controller/reference/reference.h"
#include "controller/types/plan_messages.h"
#include "controller/types/step_types.h"

namespace flexarm {

/// When a plan is asked for, and from when on it holds. Periods of the loop.
struct PlanSchedule {
  int every, ready, rest;
  std::int64_t period_ns;
};

/// The control task's side of the law `receding-horizon`: asks for plans of the rest of a move, and
/// takes what the plan that holds says. Never waits: while there is none, the closed form serves.
///
/// A motion's first plan is asked for `ready` periods before it begins, so that it holds from the
/// beginning on; then one every `every` periods, until `ready` are left. A plan ends `rest` periods
/// after the motion, or where the next one begins. Real-time: safe after construction.
class PlanFollower {
 public:
  PlanFollower(const PlanSchedule& schedule, PlanRequestChannel* requests, MotionPlanChannel* plans)
      : schedule_(schedule), requests_(requests), plans_(plans) {}

  /// A run starts: plans of earlier ones are over.
  void Start(std::uint32_t run) noexcept;

  /// The plan's sample for the torque of `sample`, or nothing.
  /// @param due_ns  of the step that computes it
  std::optional<PlanSample> At(int sample, std::int64_t due_ns) noexcept;

  /// Asks for a plan if it is time to. After the step that computed the torque of `sample`.
  void Ask(int sample, std::int64_t due_ns, const ReferenceTable& reference,
           const StepOutput& output) noexcept;

 private:
  void Send(int sample, std::int64_t due_ns, const MotionSegment& segment, int last,
            const ReferenceTable& reference, const StepOutput& output) noexcept;

  PlanSchedule schedule_;
  PlanRequestChannel* requests_;
  MotionPlanChannel* plans_;
  PlanRequest request_{};
  int next_ask_ = 0;  // first sample of the next plan of this segment
};

}  // namespace flexarm
