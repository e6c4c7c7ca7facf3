#include "controller/tasks/follow_reference.h"

namespace flexarm {
namespace {

ReferenceSample AtSamplingInstant(const TimedReference& reference, const LoopGrid& grid,
                                  int sample) noexcept {
  const std::int64_t late_ns = grid.late_ns();
  std::int64_t back = 1 + late_ns / grid.period_ns;  // whole periods, rounded up
  if (late_ns % grid.period_ns > 0) ++back;
  const std::int64_t beyond_ns = (back - 1) * grid.period_ns - late_ns;
  const int k = sample - static_cast<int>(back);
  ReferenceSample now = reference.At(k);
  if (beyond_ns == 0) return now;
  const double share = static_cast<double>(beyond_ns) / static_cast<double>(grid.period_ns);
  const ReferenceSample after = reference.At(k + 1);
  for (std::size_t i = 0; i < now.x_m.size(); ++i)
    now.x_m[i] += share * (after.x_m[i] - now.x_m[i]);
  return now;
}

}  // namespace

void FollowReference(const TimedReference& reference, const LoopGrid& grid, int sample, int acts,
                     StepInput* input) noexcept {
  input->reference_now = AtSamplingInstant(reference, grid, sample);
  input->reference_next = reference.At(acts);
  input->path = reference.PathAround(acts);
  input->same_load = reference.KeepsLoad(acts) ? 1 : 0;
  input->load_changes = reference.LoadChanges(acts) ? 1 : 0;
  input->reference_ended = sample >= reference.periods() - 1 ? 1 : 0;
}

}  // namespace flexarm
