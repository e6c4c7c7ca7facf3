#pragma once

#include <Eigen/Core>
#include <cmath>

#include "estimator/payload_filter.h"
#include "model/arm/arm_model.h"
#include "model/rigid_joint/tip_acceleration.h"
#include "model/simulation/arm_simulator.h"
#include "tests/support/study_payload.h"

namespace flexarm {

inline constexpr double kCount_rad = 2.0 * M_PI / 2540.0;       // of both hubs and rotor 1
inline constexpr double kFineCount_rad = 2.0 * M_PI / 24480.0;  // of rotor 2
inline constexpr double kTipLag_s = 8e-4;  // of the accelerometer's filter, 200 Hz

inline double Rounded(double angle, double quantum) {
  return quantum * std::round(angle / quantum);
}

/// The elastic arm with quantised angles and filtered modal coordinates.
class QuantisedArm {
 public:
  explicit QuantisedArm(const ArmParameters& p)
      : model_(p, {2, 2}), simulator_(model_), x_(model_.dof()) {}

  PayloadFilter::Outputs Run(const Eigen::Vector2d& torque) {
    constexpr int kSteps = 40;
    const double h = kPeriod_s / kSteps, share = 1.0 - std::exp(-2.0 * M_PI * kGauge_hz * h);
    for (int i = 0; i < kSteps; ++i) {
      const ArmState before = x_;
      simulator_.Step(x_, torque, h);
      const double tip_m_s2 =
          TipAcceleration(model_, ArmVector(0.5 * (before.q + x_.q)),
                          ArmVector(0.5 * (before.v + x_.v)), ArmVector((x_.v - before.v) / h));
      tip_m_s2_ += (1.0 - std::exp(-h / kTipLag_s)) * (tip_m_s2 - tip_m_s2_);
      phi_f_ += share * (x_.q.tail<4>() - phi_f_);
    }
    PayloadFilter::Outputs z;
    for (int i = 0; i < 4; ++i) z[i] = Rounded(x_.q[i], i < 3 ? kCount_rad : kFineCount_rad);
    z.tail<4>() = phi_f_;
    return z;
  }

  /// Acceleration of the tip behind the filter of an accelerometer.
  double tip_m_s2() const { return tip_m_s2_; }

 private:
  ArmModel model_;
  ArmSimulator simulator_;
  ArmState x_;
  Eigen::Vector4d phi_f_ = Eigen::Vector4d::Zero();
  double tip_m_s2_ = 0.0;
};

}  // namespace flexarm
