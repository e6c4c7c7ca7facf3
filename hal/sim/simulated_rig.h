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

/// The arm, its drives, its switches and its sensors, simulated: a passive object that whoever owns
/// it advances. Starts at rest at zero, switches closed.
///
/// Drive: the torque follows its set-point with the electrical lag of (3.24), first order.
/// Switches: a limit switch opens while its hub is beyond the switch angle or while it is held open
/// by Press.
/// Real-time: all but the constructor are safe.
class SimulatedRig {
 public:
  /// @param arm  the plant's parameters, with the payload that it really carries
  SimulatedRig(const ArmParameters& arm, const SensorConfig& sensors, const SimConfig& sim);

  std::int64_t step_ns() const noexcept { return step_ns_; }

  /// Set-point of the drives from now on, at the gearbox output.
  void SetTorque(const std::array<double, 2>& torque_nm) noexcept { set_point_nm_ = torque_nm; }

  /// One integration step.
  void Step() noexcept;

  /// What the converters show now, every strain channel at once.
  SensorFrame Sample(std::int64_t now_ns) noexcept;

  /// Begins a frame: counters, accelerometer and lines now, the strain channels `channel_skew_us`
  /// apart, the first of them now. The others follow in Step, between its ends by a straight line:
  /// next to a signal of w rad/s that errs by (w h)^2 / 8, 4e-4 of the second modes.
  void StartFrame(std::int64_t now_ns) noexcept;
  /// The frame that was begun, once its last channel has been sampled; then never again.
  std::optional<SensorFrame> TakeFrame() noexcept;

  LineLevels levels() const noexcept;

  /// Forces a line to a level (0 or 1) until it is forced to the other. A limit switch forced to 1
  /// still opens by the arm's own angle.
  void Press(Line line, int level) noexcept;

  /// The arm carries this from now on; where it is and how it moves does not change by that.
  /// ArmModel::CarryPayload says what becomes of the momentum.
  void CarryPayload(double payload_kg) noexcept;

  /// For metrics and pictures.
  PlantTruth truth() const noexcept;
  const ArmState& state() const noexcept { return state_; }

 private:
  // One step of the arm, as the accelerometer feels it.
  void SampleAccelerometer(const ArmState& before) noexcept;
  // Samples the channels whose turn comes until `until_ns` after the frame's begin.
  void SampleChannels(std::int64_t until_ns, const ArmVector& before) noexcept;

  ArmModel arm_;
  ArmSimulator simulator_;
  SimulatedSensors sensors_;
  ArmState state_;
  GaugeFilter filter_;  // of the modal coordinates
  std::optional<SimulatedAccelerometer> accelerometer_;
  std::int64_t step_ns_;
  std::array<DcMotor, 2> motor_;
  std::array<double, 2> switch_angle_rad_;
  std::array<double, 2> set_point_nm_{};
  LineLevels forced_ = kHealthyLevels;

  std::int64_t skew_ns_;
  std::optional<SensorFrame> frame_;  // begun
  std::size_t next_channel_ = 0;      // of it
  std::int64_t frame_age_ns_ = 0;
};

}  // namespace flexarm
