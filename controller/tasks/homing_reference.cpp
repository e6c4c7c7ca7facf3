#include "controller/tasks/homing_reference.h"

#include <cmath>

namespace flexarm {

void HomingReference::Start(const HomingPlan& plan, const std::array<double, 2>& hub_rad) noexcept {
  plan_ = plan;
  goal_rad_ = hub_rad;
  left_rad_ = plan.travel_rad;
  found_ = false;
  ended_ = false;
}

ReferenceSample HomingReference::Next(LineLevels levels,
                                      const std::array<double, 2>& hub_rad) noexcept {
  const bool open = (levels & LineBit(plan_.line)) == 0;
  if (open && !found_) {
    found_ = true;
    left_rad_ = plan_.back_rad;
    goal_rad_[plan_.joint] = hub_rad[plan_.joint];
  }
  if (left_rad_ > 0.0) {
    goal_rad_[plan_.joint] += found_ ? -plan_.step_rad : plan_.step_rad;
    left_rad_ -= std::fabs(plan_.step_rad);
  }
  ended_ = !(left_rad_ > 0.0);
  ReferenceSample sample{};
  sample.x_m[0] = goal_rad_[0];
  sample.x_m[1] = goal_rad_[1];
  return sample;
}

}  // namespace flexarm
