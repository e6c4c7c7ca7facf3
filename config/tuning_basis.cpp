#include "config/tuning_basis.h"

namespace flexarm {

TuningBasis TuningBasisOf(const ControlConfig& config) {
  return {.arm = config.arm,
          .sensors = config.sensors,
          .period_s = config.loop.period_s(),
          .torque_limit_nm = config.safety.torque_limit_nm,
          .strain_limit = config.safety.strain_limit,
          .payload_range_kg = config.controller.payload_range_kg};
}

}  // namespace flexarm
