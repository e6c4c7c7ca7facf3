#pragma once

#include <cmath>

namespace flexarm {

/// First-order lag of a DC motor's torque, (3.24): tau = C i (1 - e^(-t/T)) after a step of the
/// current i, so T tau' + tau = C i; T the sum of its electrical and mechanical time constants.
/// (The thesis neglects the mechanical one as the smaller; in a DC motor it is the larger. Only the
/// sum T matters.)
///
/// Advanced exactly over steps in which the set-point C i is held. Torques at the gearbox output.
/// Real-time: Step is safe.
class DcMotor {
 public:
  DcMotor() = default;  ///< without lag
  /// @param time_constant_s  T >= 0; 0: no lag
  DcMotor(double step_s, double time_constant_s)
      : blend_(time_constant_s > 0.0 ? 1.0 - std::exp(-step_s / time_constant_s) : 1.0) {}

  /// Advances by one step. @returns the torque at its middle, N m, second order in the step
  double Step(double set_point_nm) noexcept {
    const double before = torque_nm_;
    torque_nm_ += blend_ * (set_point_nm - before);
    return blend_ == 1.0 ? torque_nm_ : 0.5 * (before + torque_nm_);
  }

  double torque_nm() const noexcept { return torque_nm_; }

 private:
  double blend_ = 1.0;  // part of the distance to the set-point covered in a step
  double torque_nm_ = 0.0;
};

}  // namespace flexarm
