#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "controller/health/health_sample.h"
#include "hal/gauge_filter.h"
#include "hal/sensor_config.h"
#include "model/arm/arm_model.h"
#include "model/arm/dc_motor.h"
#include "model/simulation/arm_simulator.h"

namespace flexarm {

/// What a parallel arm needs beyond the arm's parameters.
struct ParallelArmSettings {
  int modes;                          ///< a link
  double period_s;                    ///< of the loop
  std::array<double, 2> motor_lag_s;  ///< of the drives' torque, first order
  /// Vibration between rotor and hub decays with this time constant, in addition to what the arm's
  /// model has; 0: not. It is for derivatives: within a run a per cent of stiffness or inertia
  /// shifts an undamped vibration by a whole turn, of which a derivative knows nothing.
  double torsion_decay_s = 0.0;
};

/// The nonlinear arm, integrated with the torques of the loop and corrected by an observer.
///
/// The observer turns each joint as a whole: hub and rotor by a e, and their rates by b e / Ts, e
/// the innovation of the joint's encoders weighted by their resolution. That is the steady Kalman
/// filter of a body that unknown small torques push, with two equal poles at kObserverRate_rad_s:
/// slow, so that the model's own errors show in the innovations before they are corrected, and fast
/// enough for the model to stay near the arm. Links bend by the torques and the hubs' motion alone:
/// no gauge corrects them, so no gauge's error reaches another's prediction.
/// Not real-time safe: sine and cosine of libm, no heap after construction.
class ParallelArm {
 public:
  static constexpr double kObserverRate_rad_s = 2.0;

  ParallelArm(const ArmParameters& arm, const SensorConfig& sensors,
              const ParallelArmSettings& settings);

  /// At rest, links straight, joints untwisted where the encoders see them.
  void StartAtRest(const HealthSample& sample) noexcept;
  /// One period of the loop.
  void Advance(const PiecewiseTorque& torque) noexcept;
  /// Corrects the state by the encoders.
  void Correct(const HealthSample& sample) noexcept;

  /// Rotor minus hub of joint 0 or 1, rad.
  double Twist_rad(std::size_t joint) const noexcept;
  /// Weight of the rotor's encoder in the innovation of joint 0 or 1; 1 - this: the hub's.
  double RotorShare(std::size_t joint) const noexcept;
  /// Prediction of an encoder `offset_s` from the present, rad.
  double Angle_rad(std::size_t counter, double offset_s) const noexcept;
  /// Prediction of a strain channel `offset_s` from the present, behind the gauges' filter, unit
  /// strain.
  double Strain(std::size_t channel, double offset_s) const noexcept;
  /// Strain of each channel (row) for a metre of each of the arm's modal coordinates (columns).
  const Eigen::MatrixXd& strain_shape() const noexcept { return strain_shape_; }

 private:
  double step_s_ = 0.0;
  int steps_;  // a period
  double position_gain_, rate_gain_per_s_;
  std::array<double, kCounters> encoder_weight_{};  // 1 / resolution^2; 0: no such encoder
  ArmModel model_;
  ArmSimulator simulator_;
  ArmState state_;
  std::array<double, 2> motor_lag_s_;
  double torsion_share_ = 1.0;  // of the rate of torsion that a step keeps
  std::array<DcMotor, 2> motor_;
  StrainInputConfig input_;
  GaugeFilter filter_;
  GaugeFilter::Signals before_;   // the filter's output a step ago
  Eigen::MatrixXd strain_shape_;  // channels x modal coordinates
};

}  // namespace flexarm
