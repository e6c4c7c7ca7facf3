#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "hal/gauge_filter.h"
#include "hal/sensor_config.h"
#include "hal/sensor_frame.h"
#include "hal/sim/plant_truth.h"
#include "hal/sim/sim_config.h"
#include "hal/sim/simulated_accelerometer.h"
#include "hal/sim/simulated_sensors.h"
#include "model/arm/arm_model.h"
#include "model/arm/dc_motor.h"
#include "model/simulation/arm_simulator.h"

namespace flexarm {

/// Simulation of the arm, its drives, switches and sensors: a passive object that its owner
/// advances. Starts at rest, at zero unless told otherwise, switches closed.
///
/// Drive: the torque follows its set-point with the electrical lag of (3.24), first order.
/// Switches: a limit switch opens while its hub is beyond the switch angle or while it is held open
/// by Press.
/// Real-time: all but the constructor are safe.
class SimulatedRig {
 public:
  /// @param arm        the plant's parameters, with the payload that is stated; sim.drift changes
  ///                   them and the sensors
  /// @param start_rad  hub angles at the start; the counters read 0 there
  SimulatedRig(const ArmParameters& arm, const SensorConfig& sensors, const SimConfig& sim,
               const std::array<double, 2>& start_rad = {});

  std::int64_t step_ns() const noexcept { return step_ns_; }

  /// Sets the torque set-point of the drives, at the gearbox output.
  void SetTorque(const std::array<double, 2>& torque_nm) noexcept { set_point_nm_ = torque_nm; }

  /// One integration step.
  void Step() noexcept;

  /// Samples all converters now, all strain channels simultaneously.
  SensorFrame Sample(std::int64_t now_ns) noexcept;

  /// Begins a frame: counters, accelerometer and lines now, the strain channels `channel_skew_us`
  /// apart, the first of them now. Step samples the others by linear interpolation over the step:
  /// for a signal of w rad/s its error is (w h)^2 / 8, 4e-4 of the second modes.
  void StartFrame(std::int64_t now_ns) noexcept;
  /// The begun frame once its last channel has been sampled; empty before, and after it was taken.
  std::optional<SensorFrame> TakeFrame() noexcept;

  LineLevels levels() const noexcept;

  /// Forces a line to a level (0 or 1) until it is forced to the other. A limit switch forced to 1
  /// still opens at the switch angle.
  void Press(Line line, int level) noexcept;

  /// Changes the stated payload; position and rates of the arm stay.
  /// ArmModel::CarryPayload defines the momentum.
  void CarryPayload(double payload_kg) noexcept;

  /// For metrics and pictures.
  PlantTruth truth() const noexcept;
  const ArmState& state() const noexcept { return state_; }

 private:
  // Advances the accelerometer by one step of the arm.
  void SampleAccelerometer(const ArmState& before) noexcept;
  // Samples the channels that are due until `until_ns` after the frame's begin.
  void SampleChannels(std::int64_t until_ns, const ArmVector& before) noexcept;

  ArmModel arm_;
  ArmSimulator simulator_;
  ArmState state_;
  SimulatedSensors sensors_;
  GaugeFilter filter_;  // filters the modal coordinates
  std::optional<SimulatedAccelerometer> accelerometer_;
  std::int64_t step_ns_;
  double payload_error_kg_;
  std::array<DcMotor, 2> motor_;
  std::array<double, 2> switch_angle_rad_;
  std::array<double, 2> set_point_nm_{};
  LineLevels forced_ = kHealthyLevels;

  std::int64_t skew_ns_;
  std::optional<SensorFrame> frame_;  // begun
  std::size_t next_channel_ = 0;      // of frame_
  std::int64_t frame_age_ns_ = 0;
};

}  // namespace flexarm
