#pragma once

#include "estimator/nominal_model.h"
#include "model/rigid_joint/rigid_joint_arm.h"

namespace flexarm {

/// The arm with rigid joints, linear about rest with straight links, for one payload and elbow
/// angle: M q'' + D q' + K q = [u; 0], layout R12. Torque modes are left out. Start-up only.
NominalModel StraightArmModel(const RigidJointArm& arm, double payload_kg, double theta2_rad);

}  // namespace flexarm
