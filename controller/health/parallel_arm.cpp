#include "controller/health/parallel_arm.h"

#include <algorithm>
#include <cmath>

#include "model/units.h"

namespace flexarm {
namespace {

Eigen::MatrixXd StrainShape(const ArmModel& model, const SensorConfig& sensors) {
  const Eigen::Index modal = model.dof() - kRigidCoordinates;
  Eigen::MatrixXd shape(static_cast<Eigen::Index>(sensors.strain.size()), modal);
  for (Eigen::Index j = 0; j < modal; ++j) {
    const Eigen::VectorXd unit = Eigen::VectorXd::Unit(model.dof(), kRigidCoordinates + j);
    for (Eigen::Index i = 0; i < shape.rows(); ++i) {
      const StrainChannelConfig& row = sensors.strain[static_cast<std::size_t>(i)];
      shape(i, j) = model.Strain(row.link, row.position_m, unit);
    }
  }
  return shape;
}

// The torque at `at`, in ticks of PiecewiseTorque from the begin of the period.
std::array<double, 2> TorqueAt(const PiecewiseTorque& torque, std::int64_t at) noexcept {
  for (const TorquePiece& piece : torque.all()) {
    if (at < piece.ticks) return piece.torque_nm;
    at -= piece.ticks;
  }
  return torque.last_nm();
}

}  // namespace

ParallelArm::ParallelArm(const ArmParameters& arm, const SensorConfig& sensors,
                         const ParallelArmSettings& settings)
    : steps_(static_cast<int>(std::ceil(settings.period_s / ArmSimulator::kDefaultStep_s - 1e-9))),
      model_(arm, ModeCount{.link1 = settings.modes, .link2 = settings.modes}),
      simulator_(model_),
      state_(model_.dof()),
      motor_lag_s_(settings.motor_lag_s),
      input_(sensors.strain_input),
      filter_(input_, settings.period_s / steps_, model_.dof() - kRigidCoordinates),
      before_(filter_.output()),
      strain_shape_(StrainShape(model_, sensors)) {
  step_s_ = settings.period_s / steps_;
  if (settings.torsion_decay_s > 0.0)
    torsion_share_ = std::exp(-step_s_ / settings.torsion_decay_s);
  const double pole = std::exp(-kObserverRate_rad_s * settings.period_s);
  position_gain_ = 1.0 - pole * pole;
  rate_gain_per_s_ = (1.0 - pole) * (1.0 - pole) / settings.period_s;
  for (const EncoderConfig& encoder : sensors.encoder) {
    const double resolution_rad = kTwoPi / encoder.counts_per_turn;
    encoder_weight_[static_cast<std::size_t>(encoder.counter)] =
        1.0 / (resolution_rad * resolution_rad);
  }
}

void ParallelArm::StartAtRest(const HealthSample& sample) noexcept {
  state_ = ArmState(model_.dof());
  for (std::size_t joint = 0; joint < 2; ++joint) {
    double sum = 0.0, weight = 0.0;
    for (const std::size_t i : {joint, joint + 2}) {
      if ((sample.angles >> i & 1U) == 0) continue;
      sum += encoder_weight_[i] * sample.angle_rad[i];
      weight += encoder_weight_[i];
    }
    const double angle_rad = weight > 0.0 ? sum / weight : 0.0;
    state_.q(static_cast<Eigen::Index>(joint)) = angle_rad;
    state_.q(static_cast<Eigen::Index>(joint) + 2) = angle_rad;
    motor_[joint] = DcMotor(step_s_, motor_lag_s_[joint]);
  }
  filter_.Settle(state_.q.tail(before_.size()));
  before_ = filter_.output();
}

void ParallelArm::Advance(const PiecewiseTorque& torque) noexcept {
  for (int i = 0; i < steps_; ++i) {
    const std::array<double, 2> set_point_nm =
        TorqueAt(torque, (2 * i + 1) * kPeriodTicks / (std::int64_t{2} * steps_));
    const Eigen::Vector2d torque_nm(motor_[0].Step(set_point_nm[0]),
                                    motor_[1].Step(set_point_nm[1]));
    simulator_.Step(state_, torque_nm, step_s_);
    // The rotor is light beside its hub: its rate follows.
    for (Eigen::Index joint = 0; joint < 2; ++joint) {
      const double hub_rate = state_.v(joint);
      state_.v(joint + 2) = hub_rate + torsion_share_ * (state_.v(joint + 2) - hub_rate);
    }
    before_ = filter_.output();
    filter_.Step(state_.q.tail(before_.size()));
  }
}

void ParallelArm::Correct(const HealthSample& sample) noexcept {
  for (std::size_t joint = 0; joint < 2; ++joint) {
    double sum_rad = 0.0, weight = 0.0;
    for (const std::size_t i : {joint, joint + 2}) {
      if ((sample.angles >> i & 1U) == 0) continue;
      const double predicted_rad = state_.q(static_cast<Eigen::Index>(i));
      sum_rad += encoder_weight_[i] * (sample.angle_rad[i] - predicted_rad);
      weight += encoder_weight_[i];
    }
    if (weight <= 0.0) continue;
    const double innovation_rad = sum_rad / weight;
    for (const std::size_t i : {joint, joint + 2}) {
      const auto coordinate = static_cast<Eigen::Index>(i);
      state_.q(coordinate) += position_gain_ * innovation_rad;
      state_.v(coordinate) += rate_gain_per_s_ * innovation_rad;
    }
  }
}

double ParallelArm::Twist_rad(std::size_t joint) const noexcept {
  const auto hub = static_cast<Eigen::Index>(joint);
  return state_.q(hub + 2) - state_.q(hub);
}

double ParallelArm::RotorShare(std::size_t joint) const noexcept {
  return encoder_weight_[joint + 2] / (encoder_weight_[joint] + encoder_weight_[joint + 2]);
}

double ParallelArm::Angle_rad(std::size_t counter, double offset_s) const noexcept {
  const auto i = static_cast<Eigen::Index>(counter);
  return state_.q(i) + offset_s * state_.v(i);
}

double ParallelArm::Strain(std::size_t channel, double offset_s) const noexcept {
  const auto shape = strain_shape_.row(static_cast<Eigen::Index>(channel));
  const double now = shape.dot(filter_.output());
  if (offset_s == 0.0) return now;
  return now + offset_s / step_s_ * (now - shape.dot(before_));
}

}  // namespace flexarm
