#pragma once

#include <Eigen/Core>

#include "estimator/estimator_config.h"
#include "estimator/nominal_model.h"
#include "hal/sensor_config.h"

namespace flexarm {

/// Steady-state Kalman filter on the nominal model with the gauges' analogue filter in it.
///
/// States: the nominal model's n, then the filtered modal coordinates phi_f' = w_f (phi - phi_f),
/// or phi_f and phi_f' of phi_f'' = w_f^2 (phi - phi_f) - 2 zeta w_f phi_f' behind a second-order
/// filter. Outputs y = [th1, th2, th3, th4, phi_f..]: 4 + 2 m rows; in a model with rigid joints
/// the rotor outputs are th3 - u1/K1 and th4 - u2/K2, equal to the hubs', u the torque applied
/// during the last interval. The gain column of an output that the rig does not have is zero: of an
/// absent encoder, and of a second mode where the gauges are fitted with the first one alone.
///   x(k|k) = x(k|k-1) + L (y - C x(k|k-1)),  x(k+1|k) = A x(k|k) + B u(k)
/// Source: docs/theory/control-law.md 7.3.
struct KalmanDesign {
  Eigen::MatrixXd A, B, C, L;
  Eigen::MatrixXd A_rate, B_rate;  ///< the same system continuous: x' = A_rate x + B_rate u, 1/s
  Eigen::MatrixXd W, P;            ///< covariances: of the process noise, of x - x(k|k-1)
  Eigen::VectorXd R;               ///< variances of the outputs; of an absent output 1
  double residual;                 ///< of the filter's Riccati equation, relative
};

/// @throws std::runtime_error when the Riccati equation has no stabilising solution: a motion that
///         is not asymptotically stable is not observable by the sensors
KalmanDesign DesignKalmanFilter(const NominalModel& nominal, const ArmParameters& arm,
                                const SensorConfig& sensors, const EstimatorConfig& estimator,
                                double period_s);

}  // namespace flexarm
