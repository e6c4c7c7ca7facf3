#include "controller/tasks/plan_follower.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

#include "controller/types/known_payload.h"

namespace flexarm {

void PlanFollower::Start(std::uint32_t run) noexcept {
  request_.run = run;
  request_.segment = -1;
}

std::optional<MotionSample> PlanFollower::At(int sample, std::int64_t due_ns) noexcept {
  const MotionPlan& motion = plans_->Read().At(due_ns).value;
  if (motion.run != request_.run || motion.number < request_.valid_from) return {};
  const std::optional<PlanEntry> entry = motion.plan.At(sample);
  if (!entry) return {};
  return entry->motion;
}

void PlanFollower::Ask(int sample, std::int64_t due_ns, const ReferenceTable& reference,
                       const StepOutput& output) noexcept {
  const int first = sample + schedule_.ready;
  if ((output.payload_warnings & kPayloadModelMismatch) != 0) {
    request_.valid_from = request_.number + 1;
    next_ask_ = first;
  }
  const std::vector<MotionSegment>& all = reference.segments();
  // The motion at `first`, or the last one before it.
  const auto next = std::upper_bound(all.begin(), all.end(), first,
                                     [](int k, const MotionSegment& s) { return k < s.first; });
  if (next == all.begin()) return;
  const MotionSegment& segment = *std::prev(next);
  if (first > segment.end - schedule_.ready) return;
  if (segment.first == request_.segment && first < next_ask_) return;
  const int rest_until = next == all.end() ? std::numeric_limits<int>::max() : next->first;
  Send(sample, due_ns, segment, std::min(segment.end + schedule_.rest, rest_until), reference,
       output);
  next_ask_ = first + schedule_.every;
}

void PlanFollower::Send(int sample, std::int64_t due_ns, const MotionSegment& segment, int last,
                        const ReferenceTable& reference, const StepOutput& output) noexcept {
  ++request_.number;
  request_.segment = segment.first;
  request_.sample = sample;
  request_.first = sample + schedule_.ready;
  request_.end = segment.end;
  request_.needed_ns = due_ns + schedule_.ready * schedule_.period_ns;
  std::copy_n(output.x_next.begin(), request_.x.size(), request_.x.begin());
  request_.known = KnownPayload(output);
  const int points = last + 1 - (sample - 1) + 1;
  request_.points = static_cast<std::uint32_t>(
      std::min(static_cast<std::size_t>(points), PlanRequest::kMostPoints));
  for (std::uint32_t i = 0; i < request_.points; ++i) {
    request_.path[i] = reference.PathAround(sample - 1 + static_cast<int>(i))[1];
  }
  requests_->Publish(request_);
}

}  // namespace flexarm
