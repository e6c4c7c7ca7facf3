#pragma once

#include <Eigen/Core>
#include <array>

#include "controller/law/law.h"
#include "estimator/state_layout.h"

namespace flexarm {

/// Gains of a PI-D law, by joint.
struct PiDGains {
  std::array<double, 2> stiffness_nm_per_rad;
  std::array<double, 2> integral_nm_per_rad_s;
  std::array<double, 2> damping_nm_s_per_rad;
};

/// The example of docs/extending.md: PI-D control of each hub.
///
///   u = K_P e + K_I int e dt - K_D theta',  e = theta_ref - theta
///
/// The derivative acts on the measurement, so a step of the reference gives no impulse. The
/// integral is held while the torque of its joint is limited (anti-windup).
/// Real-time: safe.
class PiDLaw final : public Law {
 public:
  /// @param layout  of x and x_m
  PiDLaw(const PiDGains& gains, const StateLayout& layout, double period_s,
         const std::array<double, 2>& torque_limit_nm);

  void Reset() noexcept override { integral_rad_s_ = {}; }
  LawOutput Compute(const LawInput& input) noexcept override;

 private:
  PiDGains gains_;
  StateLayout layout_;
  double period_s_;
  std::array<double, 2> torque_limit_nm_;
  std::array<double, 2> integral_rad_s_{};
};

}  // namespace flexarm
