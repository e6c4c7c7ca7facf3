#pragma once

#include <cmath>

#include "model/parameters/arm_parameters.h"

namespace flexarm {

/// Torques of joint 2's gears and spring at one twist, with the derivatives of an implicit step.
struct Joint2Torque {
  double spring_nm;             ///< on th2, its opposite on th4
  double stiffness_nm_per_rad;  ///< d spring / d twist
  double damping_nms_per_rad;   ///< d spring / d twist rate
  double drag_nm;               ///< on th4, against positive rates
  double drag_slope_nms;        ///< d drag / d th4'
};

/// Backlash between the gears of joint 2, in series with the joint's spring.
///
/// Twist = th4 - th2. "dead_zone", the default: with p = |twist| - d_b/2 > 0,
///   torque = K_2 p (1 + 3/2 zeta p') sign(twist), never attractive; zero within the clearance.
/// The spring is the compliance of the contact; Hunt and Crossley's loss gives an impact at rate v
/// the restitution e = 1 - zeta v + O(v^2), the thesis's formula (J. Appl. Mech. 42 (1975) 440).
///
/// "thesis": a drag on the rotor from V_B = Delta E / (2 Delta t), (3.9)-(3.11), spring unchanged:
///   drag = mu zeta v^3 (4 - 5 zeta |v|) / (2 d_b), v = th4', mu = I_1 I_2 / (I_1 + I_2).
/// Kept for comparison; its errors: (a) it acts always, not only when teeth meet, and never frees
/// the joint; (b) above |v| = 0.8 / zeta it adds energy, above 1 / zeta the restitution itself is
/// negative; (c) d_b -> 0 means infinite, not zero, damping; (d) it is the Rayleigh form of a
/// function of degree 4 and 5: it dissipates up to twice Delta E / Delta t; (e) zeta is in
/// s/m, th4' in rad/s; (f) the appendix has the wrong sign in B_4 and lacks the 1/2. I_1 and I_2
/// are not defined: taken here as J_2 and the inertia of all that turns with hub 2, undeformed.
/// Source: thesis 3.4, Appendix A's B_X; docs/theory/plant.md 4.3. Real-time: safe.
class Backlash {
 public:
  /// @param load_inertia_kgm2  of all that turns with hub 2, about the elbow
  Backlash(const ArmParameters& p, double load_inertia_kgm2) noexcept
      : model_(p.joint2_backlash.model),
        d_b_(p.joint2_backlash.clearance_rad),
        zeta_(p.joint2_backlash.restitution_slope_s_per_rad),
        K2_(p.joint[1].stiffness_nm_per_rad),
        mu_(p.joint[1].rotor_inertia_kgm2 * load_inertia_kgm2 /
            (p.joint[1].rotor_inertia_kgm2 + load_inertia_kgm2)) {}

  /// False without backlash: joint 2 is then its spring alone.
  bool active() const noexcept { return d_b_ > 0.0; }
  bool breaks_spring() const noexcept { return active() && model_ == BacklashModel::kDeadZone; }

  /// @param twist_rad, twist_rate_rad_s  th4 - th2
  /// @param rotor_rate_rad_s             th4'
  Joint2Torque At(double twist_rad, double twist_rate_rad_s,
                  double rotor_rate_rad_s) const noexcept {
    if (breaks_spring()) return Contact(twist_rad, twist_rate_rad_s);
    Joint2Torque out{K2_ * twist_rad, K2_, 0.0, 0.0, 0.0};
    if (active()) AddDrag(rotor_rate_rad_s, &out);
    return out;
  }

  /// Twist x of the spring beyond the clearance, rad: its energy is 1/2 K_2 x^2.
  double Wound(double twist_rad) const noexcept {
    if (!breaks_spring()) return twist_rad;
    return std::fmax(std::fabs(twist_rad) - 0.5 * d_b_, 0.0);
  }

 private:
  Joint2Torque Contact(double twist, double twist_rate) const noexcept {
    const double sign = twist < 0.0 ? -1.0 : 1.0;
    const double p = sign * twist - 0.5 * d_b_;
    const double loss = 1.0 + 1.5 * zeta_ * sign * twist_rate;
    if (p <= 0.0 || loss <= 0.0) return {0.0, 0.0, 0.0, 0.0, 0.0};
    return {sign * K2_ * p * loss, K2_ * loss, 1.5 * zeta_ * K2_ * p, 0.0, 0.0};
  }

  void AddDrag(double v, Joint2Torque* out) const noexcept {
    const double speed = std::fabs(v), scale = mu_ * zeta_ / (2.0 * d_b_);
    out->drag_nm = scale * v * v * v * (4.0 - 5.0 * zeta_ * speed);
    out->drag_slope_nms = scale * v * v * (12.0 - 20.0 * zeta_ * speed);
  }

  BacklashModel model_;
  double d_b_, zeta_;
  double K2_, mu_;
};

}  // namespace flexarm
