#pragma once

#include <Eigen/Core>
#include <array>

#include "controller/types/control_config.h"

namespace flexarm {

/// Gives the strain of the links priority over tracking, before the trip: the torque that would
/// bend a link further is reduced while the link is bent, or soon will be.
///
///   a = (strain + t_lead strain') / limit of each link's root, by the state
///   feedback that bends the link by +a  <=  0.2 M_limit (1 - a / 0.8), and likewise by -a; >= 0
///   feedforward that bends further      x  1 where |a| < 0.75, 0 where |a| >= 1, linear between
///
/// M_limit is the bending moment at the strain limit, t_lead a quarter of the period of the lowest
/// torque mode: the links bend on by as much before a torque straightens them. On a move that keeps
/// its share of the limits nothing is reduced. The trip stays behind it:
/// SafetyConfig::strain_limit. Source: docs/theory/fast-moves.md 4. Real-time: all but the
/// constructor is safe.
class BendingGuard {
 public:
  using State = Eigen::Matrix<double, 12, 1>;

  /// Start-up: computes mode shapes.
  explicit BendingGuard(const ControlConfig& config);

  /// @param x               state at the instant at which the torque acts, order of RigidJointArm
  /// @param feedforward_nm  torque of the motion, friction included
  /// @param feedback_nm     torque added to it
  void Limit(const State& x, Eigen::Vector2d* feedforward_nm,
             Eigen::Vector2d* feedback_nm) const noexcept;

 private:
  struct Link {
    std::array<double, 2> strain_per_m;  // of its two modes
    double strain_limit;
    double moment_nm;  // at that strain
  };

  std::array<Link, 2> link_;
  double lead_s_ = 0.0;
};

}  // namespace flexarm
