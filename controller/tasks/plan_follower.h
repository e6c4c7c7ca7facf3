#pragma once

#include <cstdint>
#include <optional>

#include "controller/reference/reference.h"
#include "controller/types/plan_messages.h"
#include "controller/types/step_types.h"

namespace flexarm {

/// Schedule of plan requests, in periods of the loop: a request every `every` periods, for a plan
/// that is valid `ready` periods later and ends `rest` periods after the motion.
struct PlanSchedule {
  int every, ready, rest;
  std::int64_t period_ns;
};

/// Part of the control task for the law `receding-horizon`: requests plans for the rest of a move,
/// and reads the plan that is valid. Never waits: without a plan the law uses its closed form.
///
/// The first plan of a motion is requested `ready` periods before the motion starts, so that it is
/// valid from its start; then one every `every` periods, until `ready` are left. A plan ends `rest`
/// periods after the motion, or where the next one starts. Real-time: safe after construction.
class PlanFollower {
 public:
  PlanFollower(const PlanSchedule& schedule, PlanRequestChannel* requests, MotionPlanChannel* plans)
      : schedule_(schedule), requests_(requests), plans_(plans) {}

  /// Start of a run: plans of earlier runs are no longer valid.
  void Start(std::uint32_t run) noexcept;

  /// Sample of the valid plan for the torque of `sample`, or nothing.
  /// @param due_ns  of the step that computes it
  std::optional<MotionSample> At(int sample, std::int64_t due_ns) noexcept;

  /// Requests a plan if the schedule demands it. After the step that computed the torque of
  /// `sample`.
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
