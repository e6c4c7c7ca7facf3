#pragma once

#include <array>

#include "controller/types/control_config.h"

namespace flexarm {

struct RestMove;

/// The limits within which the fastest move is searched. Index 0 is joint or link 1.
///
/// Not among them: the limit of the torque's rate of change. Friction is none.
struct BoundLimits {
  std::array<double, 2> torque_nm;  ///< of the drives, at the gearbox output
  /// Bending moment EI strain_limit / (h/2) at which the link's surface reaches its strain limit,
  /// N m, at the root of the weakest section.
  std::array<double, 2> root_moment_nm;
  std::array<double, 2> strain;          ///< surface strain at the root
  std::array<double, 2> hub_rate_rad_s;  ///< |th'|
  std::array<double, 2> hub_angle_rad;   ///< |th|
  /// Surface strain per modal coordinate, 1/m, of two modes a link: RootStrainShape.
  std::array<std::array<double, 2>, 2> root_strain_per_m;

  /// What the hub of a rigid arm may exert: the lesser of drive and root moment, N m. The rotor's
  /// inertia is neglected: its torque does not bend the link.
  std::array<double, 2> rigid_torque_nm() const;
};

/// Share of limits.torque_limit_nm that a plan may use: controller.plan.torque_share, or 1 without
/// [controller.plan].
double PlanTorqueShare(const ControlConfig& config);

/// @param torque_share  of limits.torque_limit_nm, 0 .. 1; the rest is for the feedback
BoundLimits BoundLimitsOf(const ControlConfig& config, double torque_share);

/// @throws RejectedError if the move stays where it is, one of its places is beyond
///         limits.soft_angle_deg, or its payload is outside controller.payload_range_kg
void CheckMove(const ControlConfig& config, const RestMove& move);

}  // namespace flexarm
