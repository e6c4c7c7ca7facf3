#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "controller/health/drift_channel.h"
#include "controller/health/drift_regression.h"
#include "controller/health/health_sample.h"
#include "controller/health/parallel_arm.h"
#include "controller/types/control_config.h"

namespace flexarm {

/// Residuals of one sensor over a run: measurement minus the parallel plant's prediction.
struct ResidualFigure {
  double mean, rms;  ///< rad, or unit strain
  double noise;      ///< sigma that is expected of the sensor and the model, same unit
};

/// The plant that is thought to be behind the sensors.
struct NominalPlant {
  double payload_kg;                  ///< that the run states
  std::array<double, 2> motor_lag_s;  ///< of the drives' torque, first order
  /// Drift of each channel about which the arm is built and linearised; empty: none. Those of
  /// gauges are not used: their effect is linear.
  std::vector<double> drift;
};

/// The nominal arm beside the rig, and beside it one arm for each parameter that differs a little;
/// all with the run's torques and the same observer. The differences of their predictions are the
/// sensitivities by which DriftRegression assigns the residual to parameters.
///
/// A joint's stiffness has no arm: its sensitivity is the twist between the two encoders. Estimated
/// beside the channels, so that they do not bias them: the drives' lag, and of each joint the
/// offset of its rotor encoder against that of its hub. Not real-time safe; takes 0.4 ms a sample.
class ParallelPlant {
 public:
  static constexpr int kModes = 4;  ///< bending modes of a link: twice those of the loop's model

  ParallelPlant(const ControlConfig& config, const NominalPlant& plant);

  /// Samples of a run, in order. At the first one the arm is at rest.
  void Take(const HealthSample& sample);

  /// Of DriftChannels, relative to NominalPlant::drift.
  std::vector<DriftFigure> Drift() const;
  /// Mean square of the weighted residuals that Drift leaves; 1 expected.
  double Misfit() const { return regression_.Misfit(); }
  /// th1 th2 th3 th4, then the strain channels.
  std::vector<ResidualFigure> Residuals() const;

 private:
  // An arm that differs in one parameter.
  struct Twin {
    ParallelArm arm;
    Eigen::Index parameter;
    double difference;
  };
  struct Sum {
    double sum = 0.0, squares = 0.0;
    std::int64_t count = 0;
  };
  // The gauges of a link.
  struct Family {
    std::vector<std::size_t> strain;       // rows of [[sensors.strain]]
    Eigen::MatrixXd covariance;            // of their residuals, unit strain squared
    std::vector<Eigen::Index> gain, zero;  // parameters
  };

  ParallelPlant(const ControlConfig& config, const NominalPlant& plant, const ArmParameters& arm);

  void AddTwins(const ArmParameters& arm, const ParallelArmSettings& settings);
  void CompareAngles(const HealthSample& sample);
  void CompareStrains(const HealthSample& sample, const Family& family);
  template <typename Prediction>
  void AddSensitivities(Prediction predict, Eigen::Index row, Eigen::MatrixXd* sensitivity) const;
  void Count(std::size_t signal, double residual);
  Eigen::Index Lag() const { return static_cast<Eigen::Index>(channels_.size()); }
  Eigen::Index Offset(std::size_t joint) const {
    return Lag() + 1 + static_cast<Eigen::Index>(joint);
  }
  Eigen::Index Parameters() const { return Lag() + 3; }

  SensorConfig sensors_;
  std::vector<DriftChannel> channels_;
  ParallelArm nominal_;  // predicts
  ParallelArm damped_;   // the same for the derivatives: torsion_decay_s
  std::vector<Twin> twin_;
  std::array<std::optional<Eigen::Index>, 2> joint_stiffness_;  // parameters
  std::array<double, kCounters> count_rad_{};                   // 0: no such encoder
  std::array<double, kCounters> angle_sigma_rad_{};             // of the predictions
  std::array<Family, 2> family_;
  DriftRegression regression_;
  std::vector<Sum> residual_;
  bool started_ = false;
};

/// Whether every number is finite, and leaves every joint and link a stiffness of its order.
bool IsPossible(const std::vector<DriftChannel>& channels, const std::vector<double>& drift);

/// The arm with its channels' drift, in the units of DriftKind; channels of gauges are left out.
/// Expects a drift that IsPossible.
ArmParameters WithDrift(ArmParameters arm, const std::vector<DriftChannel>& channels,
                        const std::vector<double>& drift);

}  // namespace flexarm
