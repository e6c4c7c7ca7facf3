#pragma once

#include "controller/law/design.h"
#include "controller/types/control_config.h"

namespace flexarm {

/// The design with which a law that follows the payload controls the arm once it has found this
/// payload: the arm's model, `ekf-payload` as the steady-state filter of that model, and the gains
/// of the table, all for one payload and elbow angle.
///
/// For the robustness analysis. Start-up only.
/// @param design  with `scheduled`
/// @throws std::runtime_error if the filter's equation has no solution
Design DesignAtPayload(const ControlConfig& config, const Design& design, double payload_kg,
                       double theta2_rad);

}  // namespace flexarm
