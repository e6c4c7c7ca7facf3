#include "controller/host/csv_reference.h"

#include "controller/tasks/follow_reference.h"

namespace flexarm {

CsvReference::CsvReference(const ControlConfig& config, const Design& design,
                           const Experiment& experiment, const std::array<double, 2>& start_rad)
    : grid_(config.loop),
      planned_(experiment, design, config.loop.period_s(), start_rad, MotionLimitsOf(config)) {}

void CsvReference::Give(int delay_found, StepInput* input) const {
  const int sample = static_cast<int>(input->tick);
  FollowReference(planned_.reference, grid_, sample, sample + delay_found, input);
}

}  // namespace flexarm
