#pragma once

#include <Eigen/Core>
#include <array>

#include "model/rigid_joint/motion_sample.h"
#include "model/rigid_joint/rigid_joint_arm.h"
#include "model/rigid_joint/rigid_point.h"

namespace flexarm {

/// Pose and torque of an arm that follows Y with quasi-static deflection, without vibration.
struct QuasiStaticPose {
  RigidJointArm::Vector q;    ///< as RigidJointArm's, rad and m
  Eigen::Vector2d torque_nm;  ///< on hubs 1 and 2, without friction
};

/// Closed form, with g the forces at q = (Y, 0), v = (Y', 0), a = (Y'', 0):
///   f = -K_ff^-1 g_f,  theta = Y - M_tt^-1 M_tf f,  u = g_t.
///
/// The links' deflection balances the inertial forces of the straight arm instantaneously.
/// Neglected: the inertia of f itself, and the geometry of the bent arm. A second pass with them
/// gained nothing.
/// Source: docs/theory/payload.md 3.3. Real-time: safe.
QuasiStaticPose QuasiStaticAt(const RigidJointArm& arm, const OutboardBody& body,
                              const RigidPoint& point) noexcept;

/// Quasi-static reference: rates are central differences over the neighbours, all with the same
/// payload. The torque is the mean of this instant and the next, for the sample between.
/// Source: docs/theory/payload.md 3.3. Real-time: safe.
/// @param previous_now_next  the path, one period apart
/// @param period_s           > 0
MotionSample QuasiStaticOver(const RigidJointArm& arm, double payload_kg,
                             const std::array<RigidPoint, 3>& previous_now_next,
                             double period_s) noexcept;

}  // namespace flexarm
