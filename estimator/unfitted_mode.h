#pragma once

#include <array>

#include "hal/sensor_config.h"
#include "model/parameters/arm_parameters.h"

namespace flexarm {

/// Metres of the fitted first modal coordinate per metre of the second one, of link 1 and link 2,
/// when the gauges are fitted with the first mode alone: the least-squares fit takes the strain of
/// the second mode for one of the first. A filter whose model has two modes a link needs it as part
/// of its output equation, f_fit = f_1 + this f_2.
///
/// Weights as in StrainFit. Start-up only.
/// @throws std::invalid_argument as ClampedModes
std::array<double, 2> SecondModeInFirst(const ArmParameters& arm, const SensorConfig& sensors);

}  // namespace flexarm
