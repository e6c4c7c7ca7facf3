#include "controller/host/csv_reference.h"

#include "controller/tasks/follow_reference.h"
#include "controller/types/known_payload.h"

namespace flexarm {

CsvReference::CsvReference(const ControlConfig& config, const Design& design,
                           const Experiment& experiment, const std::array<double, 2>& start_rad)
    : grid_(config.loop),
      planned_(experiment, design, config.loop.period_s(), start_rad, MotionLimitsOf(config)) {
  reference_.Start(&planned_.reference, &planned_.load_change);
}

void CsvReference::Give(const StepOutput& before, StepInput* input) {
  const int sample = static_cast<int>(input->tick);
  const int acts = sample + before.delay_found;
  reference_.Choose(acts, KnownPayload(before));
  FollowReference(reference_, grid_, sample, acts, input);
}

}  // namespace flexarm
