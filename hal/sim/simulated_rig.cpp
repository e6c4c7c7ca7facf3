#include "hal/sim/simulated_rig.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "model/rigid_joint/tip_acceleration.h"
#include "model/units.h"

namespace flexarm {

namespace {

// At rest: a rotor is where its hub is, the links are straight.
ArmState RestAt(int dof, const std::array<double, 2>& hub_rad) {
  ArmState state(dof);
  state.q(kTheta1) = state.q(kTheta3) = hub_rad[0];
  state.q(kTheta2) = state.q(kTheta4) = hub_rad[1];
  return state;
}

}  // namespace

SimulatedRig::SimulatedRig(const ArmParameters& arm, const SensorConfig& sensors,
                           const SimConfig& sim, const std::array<double, 2>& start_rad)
    : arm_(Drifted(arm, sim.drift), ModeCount{.link1 = sim.plant_modes, .link2 = sim.plant_modes}),
      simulator_(arm_),
      state_(RestAt(arm_.dof(), start_rad)),
      sensors_(arm_, Drifted(sensors, sim.drift), sim.seed, state_.q),
      filter_(sensors.strain_input, sim.step_ms * 1e-3, arm_.dof() - kRigidCoordinates),
      step_ns_(std::llround(sim.step_ms * 1e6)),
      payload_error_kg_(sim.drift.payload_error_kg),
      skew_ns_(std::llround(sim.channel_skew_us * 1e3)) {
  for (std::size_t i = 0; i < 2; ++i) {
    motor_[i] = DcMotor(sim.step_ms * 1e-3, sim.motor_lag_ms[i] * 1e-3);
    switch_angle_rad_[i] = RadFromDeg(sim.switch_angle_deg[i]);
  }
  if (!sensors.tip_accelerometer) return;
  accelerometer_.emplace(*sensors.tip_accelerometer, sim.step_ms * 1e-3, sim.seed);
}

void SimulatedRig::Step() noexcept {
  // The torque at the middle of the step is used, so the lag is of second order like the arm.
  Eigen::Vector2d torque;
  for (std::size_t i = 0; i < 2; ++i) {
    torque(static_cast<Eigen::Index>(i)) = motor_[i].Step(set_point_nm_[i]);
  }
  const double h = static_cast<double>(step_ns_) * 1e-9;
  if (accelerometer_) {
    const ArmState start = state_;
    simulator_.Step(state_, torque, h);
    SampleAccelerometer(start);
  } else {
    simulator_.Step(state_, torque, h);
  }
  const auto modes = state_.q.tail(filter_.output().size());
  if (!frame_) {
    filter_.Step(modes);
    return;
  }
  const ArmVector before(filter_.output());
  filter_.Step(modes);
  SampleChannels(frame_age_ns_ + step_ns_, before);
  frame_age_ns_ += step_ns_;
}

// The step's mean acceleration: including the impulse of a hub that stops within it.
void SimulatedRig::SampleAccelerometer(const ArmState& before) noexcept {
  const double h = static_cast<double>(step_ns_) * 1e-9;
  accelerometer_->Step(TipAcceleration(arm_, ArmVector(0.5 * (before.q + state_.q)),
                                       ArmVector(0.5 * (before.v + state_.v)),
                                       ArmVector((state_.v - before.v) / h)));
}

void SimulatedRig::StartFrame(std::int64_t now_ns) noexcept {
  frame_ = sensors_.SampleCounters(now_ns, state_.q, levels());
  if (accelerometer_) accelerometer_->Sample(&*frame_);
  next_channel_ = 0;
  frame_age_ns_ = 0;
  SampleChannels(0, ArmVector(filter_.output()));
}

std::optional<SensorFrame> SimulatedRig::TakeFrame() noexcept {
  if (next_channel_ < sensors_.strain_channels()) return std::nullopt;
  return std::exchange(frame_, std::nullopt);
}

void SimulatedRig::SampleChannels(std::int64_t until_ns, const ArmVector& before) noexcept {
  const ArmVector after(filter_.output());
  for (; next_channel_ < sensors_.strain_channels(); ++next_channel_) {
    const std::int64_t offset_ns = static_cast<std::int64_t>(next_channel_) * skew_ns_;
    if (offset_ns > until_ns) return;
    const double share =
        1.0 - static_cast<double>(until_ns - offset_ns) / static_cast<double>(step_ns_);
    const ArmVector filtered = share == 1.0 ? after : ArmVector(before + share * (after - before));
    sensors_.SampleStrain(next_channel_, static_cast<std::int32_t>(offset_ns), filtered, &*frame_);
  }
}

SensorFrame SimulatedRig::Sample(std::int64_t now_ns) noexcept {
  SensorFrame frame = sensors_.Sample(now_ns, state_.q, ArmVector(filter_.output()), levels());
  if (accelerometer_) accelerometer_->Sample(&frame);
  return frame;
}

LineLevels SimulatedRig::levels() const noexcept {
  LineLevels levels = forced_;
  const std::array<Line, 2> low = {Line::kLimit1Low, Line::kLimit2Low};
  const std::array<Line, 2> high = {Line::kLimit1High, Line::kLimit2High};
  for (std::size_t i = 0; i < 2; ++i) {
    const double angle = state_.q(static_cast<Eigen::Index>(i));
    if (angle < -switch_angle_rad_[i]) levels &= ~LineBit(low[i]);
    if (angle > switch_angle_rad_[i]) levels &= ~LineBit(high[i]);
  }
  return levels;
}

void SimulatedRig::Press(Line line, int level) noexcept {
  if (level != 0) {
    forced_ |= LineBit(line);
  } else {
    forced_ &= ~LineBit(line);
  }
}

void SimulatedRig::CarryPayload(double payload_kg) noexcept {
  arm_.CarryPayload(std::max(0.0, payload_kg + payload_error_kg_));
  simulator_.CarryPayloadOf(arm_);
}

PlantTruth SimulatedRig::truth() const noexcept {
  const Eigen::Index m1 = arm_.mode_count().link1, m2 = arm_.mode_count().link2;
  const LinkModes& link1 = arm_.link_modes(1);
  // Shapes have psi(L) = 1: the deflection of a tip is the sum of its modal coordinates.
  const double w1 = state_.q.segment(kPhi1, m1).sum(), w2 = state_.q.tail(m2).sum();
  double slope = 0.0;
  for (Eigen::Index i = 0; i < m1; ++i) slope += link1.slope_tip(i) * state_.q(kPhi1 + i);
  const double th1 = state_.q(kTheta1), gamma = th1 + std::atan(slope) + state_.q(kTheta2);
  double L1 = link1.length_m, L2 = arm_.link_modes(2).length_m;
  if (arm_.constants().foreshortening) {
    L1 -= TipShortening(arm_.constants().shortening1, state_.q.segment(kPhi1, m1));
    L2 -= TipShortening(arm_.constants().shortening2, state_.q.tail(m2));
  }
  return {.hub_angle_rad = {th1, state_.q(kTheta2)},
          .tip_m = {L1 * std::cos(th1) - w1 * std::sin(th1) + L2 * std::cos(gamma) -
                        w2 * std::sin(gamma),
                    L1 * std::sin(th1) + w1 * std::cos(th1) + L2 * std::sin(gamma) +
                        w2 * std::cos(gamma)},
          .tip_deflection_m = {w1, w2},
          .known = true};
}

}  // namespace flexarm
