#include "estimator/payload_estimator.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "estimator/gauge_model.h"
#include "estimator/unfitted_mode.h"

namespace flexarm {
namespace {

// Standard deviations of the state at the start: at rest, at the measured angles.
constexpr double kStartMotion = 1e-3;  // hubs and all rates, rad and m, and per second
constexpr double kStartBent_m = 1e-4;  // modal coordinates, and the states of the gauges' filters

// Difference for a derivative by friction: a hundredth of the level.
constexpr double kFrictionProbe = 0.01;
constexpr double kLeastFrictionProbe_nm = 1e-4;

// Bits of PayloadFilterConfig::outputs.
constexpr std::uint32_t kFirstModeOutputs = 0b0101'0000, kSecondModeOutputs = 0b1010'0000;

double OfQuantum(double quantum, double extra) {
  return std::sqrt(quantum * quantum / 12.0 + extra * extra);
}

// Rad per count of the counter; 0 without such an encoder.
double Quantum(const SensorConfig& sensors, int counter) {
  for (const EncoderConfig& encoder : sensors.encoder) {
    if (encoder.counter == counter) return 2.0 * std::numbers::pi / encoder.counts_per_turn;
  }
  return 0.0;
}

PayloadFilter::Reading ReadingOf(const DecodedCounters& counters, const FittedModes& modes,
                                 std::optional<double> tip_m_s2) noexcept {
  PayloadFilter::Reading reading{.z = {}, .good = counters.good & 0b1111u, .tip_m_s2 = tip_m_s2};
  for (std::size_t i = 0; i < 4; ++i) {
    reading.z[static_cast<int>(i)] = counters.angle_rad[i];
    reading.z[static_cast<int>(4 + i)] = modes.modal_m[i];
    if (modes.valid[i / 2]) reading.good |= 1u << (4 + i);
  }
  return reading;
}

}  // namespace

std::vector<double> PayloadModelConstants(const ArmParameters& arm, const SensorConfig& sensors,
                                          double period_s) {
  return RigidJointStepper(RigidJointArm(arm), period_s, LagCorner_hz(sensors.strain_input))
      .Constants();
}

PayloadFilterConfig PayloadFilterFor(const ArmParameters& arm, const SensorConfig& sensors,
                                     const EstimatorConfig& config) {
  const PayloadEstimatorConfig& p = *config.payload;
  PayloadFilterConfig c{};
  for (std::size_t i = 0; i < 2; ++i) {
    c.joint_stiffness_nm_per_rad[i] = arm.joint[i].stiffness_nm_per_rad;
    c.friction_start_nm[i] = arm.joint[i].coulomb_friction_nm;
    c.friction_probe_nm[i] =
        std::max(kLeastFrictionProbe_nm, kFrictionProbe * arm.joint[i].coulomb_friction_nm);
    c.output_sigma[i] =
        OfQuantum(Quantum(sensors, static_cast<int>(i)), config.hub_extra_sigma_rad[i]);
    c.output_sigma[2 + i] =
        OfQuantum(Quantum(sensors, 2 + static_cast<int>(i)), p.rotor_extra_sigma_rad[i]);
  }
  std::copy(config.modal_sigma_m.begin(), config.modal_sigma_m.end(), c.output_sigma.begin() + 4);
  c.outputs = sensors.counters_present() | kFirstModeOutputs;
  if (config.modes_per_link == 2) {
    c.outputs |= kSecondModeOutputs;
  } else {
    c.second_in_first = SecondModeInFirst(arm, sensors);
  }
  c.process_force = p.process_force;
  c.start_sigma.fill(kStartBent_m);
  std::fill_n(c.start_sigma.begin(), 2, kStartMotion);
  std::fill_n(c.start_sigma.begin() + RigidJointArm::kDof, RigidJointArm::kDof, kStartMotion);
  c.payload_start_kg = p.start_kg;
  c.payload_start_sigma_kg = c.payload_max_sigma_kg = p.start_sigma_kg;
  c.payload_max_kg = p.max_kg;
  c.payload_move_sigma_kg = p.move_sigma_kg;
  c.payload_walk_kg = p.walk_kg;
  c.payload_min_rate_rad_s = p.min_rate_rad_s;
  c.friction_start_sigma_nm = p.friction_start_sigma_nm;
  c.friction_max_nm = p.friction_max_nm;
  c.friction_walk_nm = p.friction_walk_nm;
  c.friction_min_rate_rad_s = p.friction_min_rate_rad_s;
  c.play_threshold_rad = p.play_threshold_counts * Quantum(sensors, 1);
  c.play_memory = p.play_memory;
  c.gate_sigmas = p.gate_sigmas;
  if (sensors.tip_accelerometer) {
    const TipAccelerometerConfig& tip = *sensors.tip_accelerometer;
    const double noise_m_s2 = tip.noise_counts * tip.m_s2_per_count();
    const double extra_m_s2 = p.tip_extra_sigma_m_s2.value();
    c.tip_sigma_m_s2 = OfQuantum(tip.m_s2_per_count(),
                                 std::sqrt(noise_m_s2 * noise_m_s2 + extra_m_s2 * extra_m_s2));
    c.tip_lag_s = tip.lag_s();
  }
  return c;
}

PayloadEstimator::PayloadEstimator(std::span<const double> model, const PayloadFilterConfig& config)
    : filter_(RigidJointStepper(model), config),
      covariance_after_rest_(filter_.CovarianceAfterRest()) {}

const PayloadFilter::Estimate& PayloadEstimator::Update(const DecodedCounters& counters,
                                                        const FittedModes& modes,
                                                        const PiecewiseTorque& applied,
                                                        std::optional<double> tip_m_s2) noexcept {
  if (!started_) StartAt(counters, modes);
  return filter_.Update(applied, ReadingOf(counters, modes, tip_m_s2));
}

const PayloadFilter::Estimate& PayloadEstimator::Update(const DecodedCounters& counters,
                                                        const FittedModes& modes,
                                                        const TorqueByDelay& applied,
                                                        std::optional<double> tip_m_s2) noexcept {
  if (!started_) StartAt(counters, modes);
  const PayloadFilter::Reading reading = ReadingOf(counters, modes, tip_m_s2);
  for (std::size_t d = 0; d < kDelays; ++d)
    hypotheses_[d].torque = applied[d].value_or(PiecewiseTorque());
  const PayloadFilter::Estimate& estimate =
      filter_.Update(hypotheses_[delay_.index()].torque, reading, hypotheses_);
  if (reading.good == 0) return estimate;
  DelayDetector::Misfit misfit;
  for (std::size_t d = 0; d < kDelays; ++d) {
    if (applied[d]) misfit[d] = hypotheses_[d].nis;
  }
  if (delay_.Take(misfit)) {
    filter_.SwitchTo(hypotheses_[delay_.index()]);
    for (PayloadFilter::Hypothesis& hypothesis : hypotheses_) hypothesis.apart.setZero();
  }
  return estimate;
}

void PayloadEstimator::StartAt(const DecodedCounters& counters, const FittedModes& modes) noexcept {
  RigidJointArm::Vector q = RigidJointArm::Vector::Zero();
  q.head<2>() << counters.angle_rad[0], counters.angle_rad[1];
  for (std::size_t i = 0; i < 4; ++i) {
    if (modes.valid[i / 2]) q[static_cast<int>(2 + i)] = modes.modal_m[i];
  }
  filter_.Reset(q, covariance_after_rest_);
  for (PayloadFilter::Hypothesis& hypothesis : hypotheses_) hypothesis.apart.setZero();
  started_ = true;
}

std::array<double, 4> PayloadEstimator::ModalRates() const noexcept {
  const GaugedState& x = filter_.estimate().state;
  const double corner_rad_s =
      filter_.stepper().gauge_share() / filter_.stepper().step_s();  // w_f, to first order
  std::array<double, 4> rates;
  for (int i = 0; i < 4; ++i) {
    rates[static_cast<std::size_t>(i)] = corner_rad_s * (x.q[2 + i] - x.phi_f[i]);
  }
  return rates;
}

}  // namespace flexarm
