#pragma once

#include "model/arm/arm_model.h"
#include "model/simulation/arm_simulator.h"

namespace flexarm {

/// Kinetic and potential energy of the arm, springs included.
inline double Energy(const ArmModel& model, const ArmState& x) {
  return model.KineticEnergy(x.q, x.v) + model.PotentialEnergy(x.q);
}

}  // namespace flexarm
