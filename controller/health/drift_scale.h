#pragma once

#include <cstddef>
#include <vector>

#include "controller/health/drift_channel.h"
#include "hal/sensor_config.h"
#include "model/parameters/arm_parameters.h"

namespace flexarm {

/// Sizes of the drift of a channel, in its unit.
struct DriftScale {
  double prior;   ///< sigma before a run is looked at: more than any drift that is looked for
  double step;    ///< difference for the derivative; 0: of a gauge or a joint's stiffness
  double linear;  ///< beyond this the arm is linearised again; 0: as for step
  double floor;   ///< sigma that is credible of one run of a real rig, whatever its data say
};

/// @param arm  the nominal one, with the stated payload
DriftScale ScaleOf(const DriftChannel& channel, const ArmParameters& arm,
                   const SensorConfig& sensors);

/// Of every channel of a rig.
std::vector<DriftScale> ScalesOf(const std::vector<DriftChannel>& channels,
                                 const ArmParameters& arm, const SensorConfig& sensors);

/// Full scale of a strain channel, unit strain.
double StrainRange(const SensorConfig& sensors, std::size_t strain);

}  // namespace flexarm
