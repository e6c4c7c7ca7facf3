#pragma once

#include "model/simulation/arm_simulator.h"

namespace flexarm {

/// The arm with its elbow bent, both joints turning and both links bent.
inline ArmState SwingingArm(const ArmModel& model) {
  ArmState x(model.dof());
  x.q[kTheta2] = x.q[kTheta4] = 1.0;
  x.v[kTheta1] = x.v[kTheta3] = 1.5;
  x.v[kTheta2] = x.v[kTheta4] = -2.5;
  x.q[kPhi1] = 0.01;
  x.q[model.constants().phi2()] = -0.02;
  return x;
}

}  // namespace flexarm
