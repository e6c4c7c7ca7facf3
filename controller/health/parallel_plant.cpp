#include "controller/health/parallel_plant.h"

#include <algorithm>
#include <cmath>

#include "controller/health/drift_scale.h"
#include "controller/health/quantised_residual.h"
#include "estimator/strain_scale.h"
#include "model/math/dense_decompositions.h"
#include "model/units.h"

namespace flexarm {
namespace {

// Errors of the model, beyond what the sensors' resolution and noise explain. They keep the noise
// of the sensors from being believed too far.
constexpr double kAngleModel_rad = 5e-5;
constexpr double kAngleModelCounts =
    0.08;  // of the joint's finer encoder, which the observer follows
constexpr double kModalShare =
    2e-3;  // of the gauges' full scale, by each mode, where it bends most

constexpr double kLagStep_s = 1e-3, kLagPrior_s = 5e-3;
constexpr double kOffsetPrior_rad = 5e-3;
constexpr double kTorsionDecay_s = 0.01;
constexpr double kBlock_s = 1.0;

constexpr double kMostStiffnessDrift = 0.9;  // relative; there the arm is another one, or broken

double NoiseOf(const SensorConfig& sensors, std::size_t strain) {
  const double noise = sensors.strain_input.noise_counts;
  return std::fabs(StrainScaleOf(sensors, strain).unit_per_count) *
         std::sqrt(noise * noise + 1.0 / 12.0);
}

// Noise of each gauge, and the bending that the model misses.
Eigen::MatrixXd StrainCovariance(const SensorConfig& sensors,
                                 const std::vector<std::size_t>& strain,
                                 const Eigen::MatrixXd& shape) {
  const auto n = static_cast<Eigen::Index>(strain.size());
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(n, n);
  Eigen::MatrixXd own(n, shape.cols());
  double range = 0.0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::size_t row = strain[static_cast<std::size_t>(i)];
    const double noise = NoiseOf(sensors, row);
    covariance(i, i) = noise * noise;
    own.row(i) = shape.row(static_cast<Eigen::Index>(row));
    range = std::max(range, StrainRange(sensors, row));
  }
  for (Eigen::Index j = 0; j < own.cols(); ++j) {
    const double most = n > 0 ? own.col(j).cwiseAbs().maxCoeff() : 0.0;
    if (most <= 0.0) continue;  // a mode of the other link
    const Eigen::VectorXd error = kModalShare * range / most * own.col(j);
    covariance += error * error.transpose();
  }
  return covariance;
}

DriftRegression::Settings RegressionOf(const ControlConfig& config, const ArmParameters& arm,
                                       const std::vector<DriftChannel>& channels) {
  DriftRegression::Settings settings;
  settings.family.resize(2);
  for (std::size_t i = 0; i < channels.size(); ++i) {
    settings.prior.push_back(ScaleOf(channels[i], arm, config.sensors).prior);
    if (channels[i].kind != DriftKind::kGaugeGain) continue;
    settings.family[static_cast<std::size_t>(channels[i].part) - 1].push_back(i);
  }
  settings.prior.insert(settings.prior.end(), {kLagPrior_s, kOffsetPrior_rad, kOffsetPrior_rad});
  settings.block_samples = static_cast<int>(std::ceil(kBlock_s / config.loop.period_s()));
  return settings;
}

ArmParameters NominalArm(const ControlConfig& config, const NominalPlant& plant) {
  ArmParameters arm = config.arm;
  arm.payload_mass_kg = plant.payload_kg;
  return WithDrift(arm, DriftChannels(config.arm, config.sensors), plant.drift);
}

ParallelArmSettings SettingsOf(const ControlConfig& config, const NominalPlant& plant,
                               double torsion_decay_s) {
  return {.modes = ParallelPlant::kModes,
          .period_s = config.loop.period_s(),
          .motor_lag_s = plant.motor_lag_s,
          .torsion_decay_s = torsion_decay_s};
}

}  // namespace

bool IsPossible(const std::vector<DriftChannel>& channels, const std::vector<double>& drift) {
  for (std::size_t i = 0; i < drift.size(); ++i) {
    if (!std::isfinite(drift[i])) return false;
    const bool of_stiffness = channels[i].kind == DriftKind::kJointStiffness ||
                              channels[i].kind == DriftKind::kLinkStiffness;
    if (of_stiffness && std::fabs(drift[i]) > kMostStiffnessDrift) return false;
  }
  return true;
}

ArmParameters WithDrift(ArmParameters arm, const std::vector<DriftChannel>& channels,
                        const std::vector<double>& drift) {
  for (std::size_t i = 0; i < drift.size(); ++i) {
    const std::size_t part = static_cast<std::size_t>(std::max(1, channels[i].part)) - 1;
    switch (channels[i].kind) {
      case DriftKind::kFriction:
        arm.joint[part].coulomb_friction_nm =
            std::max(0.0, arm.joint[part].coulomb_friction_nm + drift[i]);
        break;
      case DriftKind::kJointStiffness:
        arm.joint[part].stiffness_nm_per_rad *= 1.0 + drift[i];
        break;
      case DriftKind::kLinkStiffness:
        for (BeamSection& section : arm.link[part].section) {
          section.youngs_modulus_pa *= 1.0 + drift[i];
          section.given_bending_stiffness_nm2 *= 1.0 + drift[i];
        }
        break;
      case DriftKind::kPayload:
        arm.payload_mass_kg = std::max(0.0, arm.payload_mass_kg + drift[i]);
        break;
      case DriftKind::kGaugeGain:
      case DriftKind::kGaugeZero:
        break;
    }
  }
  return arm;
}

ParallelPlant::ParallelPlant(const ControlConfig& config, const NominalPlant& plant)
    : ParallelPlant(config, plant, NominalArm(config, plant)) {}

ParallelPlant::ParallelPlant(const ControlConfig& config, const NominalPlant& plant,
                             const ArmParameters& arm)
    : sensors_(config.sensors),
      channels_(DriftChannels(config.arm, config.sensors)),
      nominal_(arm, sensors_, SettingsOf(config, plant, 0.0)),
      damped_(arm, sensors_, SettingsOf(config, plant, kTorsionDecay_s)),
      regression_(RegressionOf(config, config.arm, channels_)),
      residual_(kCounters + sensors_.strain.size()) {
  AddTwins(arm, SettingsOf(config, plant, kTorsionDecay_s));
  for (const EncoderConfig& encoder : sensors_.encoder) {
    count_rad_[static_cast<std::size_t>(encoder.counter)] = kTwoPi / encoder.counts_per_turn;
  }
  for (std::size_t i = 0; i < kCounters; ++i) {
    const double hub = count_rad_[i % 2], rotor = count_rad_[i % 2 + 2];
    const double finer_rad = rotor > 0.0 ? std::min(hub, rotor) : hub;
    angle_sigma_rad_[i] = std::hypot(kAngleModel_rad, kAngleModelCounts * finer_rad);
  }
  for (Family& family : family_) {
    family.covariance = StrainCovariance(sensors_, family.strain, nominal_.strain_shape());
  }
}

void ParallelPlant::AddTwins(const ArmParameters& arm, const ParallelArmSettings& settings) {
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    const DriftChannel& channel = channels_[i];
    const auto parameter = static_cast<Eigen::Index>(i);
    const std::size_t part = static_cast<std::size_t>(std::max(1, channel.part)) - 1;
    if (channel.kind == DriftKind::kGaugeGain) family_[part].gain.push_back(parameter);
    if (channel.kind == DriftKind::kGaugeGain) family_[part].strain.push_back(channel.strain);
    if (channel.kind == DriftKind::kGaugeZero) family_[part].zero.push_back(parameter);
    if (channel.kind == DriftKind::kJointStiffness) joint_stiffness_[part] = parameter;
    const double step = ScaleOf(channel, arm, sensors_).step;
    if (step <= 0.0) continue;
    twin_.push_back({.arm = ParallelArm(WithDrift(arm, {channel}, {step}), sensors_, settings),
                     .parameter = parameter,
                     .difference = step});
  }
  ParallelArmSettings late = settings;
  for (double& lag_s : late.motor_lag_s) lag_s += kLagStep_s;
  twin_.push_back(
      {.arm = ParallelArm(arm, sensors_, late), .parameter = Lag(), .difference = kLagStep_s});
}

void ParallelPlant::Take(const HealthSample& sample) {
  const auto each = [this](auto action) {
    action(nominal_);
    action(damped_);
    for (Twin& twin : twin_) action(twin.arm);
  };
  if (!started_) {
    started_ = true;
    each([&sample](ParallelArm& arm) { arm.StartAtRest(sample); });
    return;
  }
  each([&sample](ParallelArm& arm) { arm.Advance(sample.applied); });
  CompareAngles(sample);
  for (const Family& family : family_) CompareStrains(sample, family);
  regression_.EndSample();
  each([&sample](ParallelArm& arm) { arm.Correct(sample); });
}

template <typename Prediction>
void ParallelPlant::AddSensitivities(Prediction predict, Eigen::Index row,
                                     Eigen::MatrixXd* sensitivity) const {
  const double damped = predict(damped_);
  for (const Twin& twin : twin_) {
    (*sensitivity)(row, twin.parameter) = (predict(twin.arm) - damped) / twin.difference;
  }
}

void ParallelPlant::CompareAngles(const HealthSample& sample) {
  Eigen::MatrixXd sensitivity = Eigen::MatrixXd::Zero(kCounters, Parameters());
  Eigen::VectorXd residual = Eigen::VectorXd::Zero(kCounters);
  for (std::size_t i = 0; i < kCounters; ++i) {
    if ((sample.angles >> i & 1U) == 0) continue;
    const auto late_s = static_cast<double>(sample.angle_late_s[i]);
    const auto predict = [i, late_s](const ParallelArm& arm) { return arm.Angle_rad(i, late_s); };
    const auto row = static_cast<Eigen::Index>(i);
    AddSensitivities(predict, row, &sensitivity);
    // The observer follows the weighted mean of a joint's encoders; what lies between hub and rotor
    // moves each away from it by the other's weight.
    const std::size_t joint = i % 2;
    const double share = i < 2 ? -nominal_.RotorShare(joint) : 1.0 - nominal_.RotorShare(joint);
    if (joint_stiffness_[joint]) {
      sensitivity(row, *joint_stiffness_[joint]) = -share * damped_.Twist_rad(joint);
    }
    sensitivity(row, Offset(joint)) = share;
    const double away_rad = sample.angle_rad[i] - predict(nominal_);
    Count(i, away_rad);
    const QuantisedResidual weighted = Quantised(away_rad, count_rad_[i], angle_sigma_rad_[i]);
    sensitivity.row(row) *= weighted.weight;
    residual(row) = weighted.residual;
  }
  regression_.Add(sensitivity, residual);
}

void ParallelPlant::CompareStrains(const HealthSample& sample, const Family& family) {
  std::vector<Eigen::Index> read;
  for (std::size_t i = 0; i < family.strain.size(); ++i) {
    if ((sample.strains >> family.strain[i] & 1U) != 0)
      read.push_back(static_cast<Eigen::Index>(i));
  }
  if (read.empty()) return;
  const auto rows = static_cast<Eigen::Index>(read.size());
  Eigen::MatrixXd sensitivity = Eigen::MatrixXd::Zero(rows, Parameters());
  Eigen::VectorXd residual(rows);
  for (Eigen::Index row = 0; row < rows; ++row) {
    const auto i = static_cast<std::size_t>(read[static_cast<std::size_t>(row)]);
    const std::size_t strain = family.strain[i];
    const auto late_s = static_cast<double>(sample.strain_late_s[strain]);
    const auto predict = [strain, late_s](const ParallelArm& arm) {
      return arm.Strain(strain, late_s);
    };
    const double predicted = predict(nominal_);
    AddSensitivities(predict, row, &sensitivity);
    sensitivity(row, family.gain[i]) = predicted;
    sensitivity(row, family.zero[i]) = 1.0;
    residual(row) = static_cast<double>(sample.strain[strain]) - predicted;
    Count(kCounters + strain, residual(row));
  }
  const Eigen::MatrixXd covariance = family.covariance(read, read);
  const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
  factor.matrixL().solveInPlace(sensitivity);
  factor.matrixL().solveInPlace(residual);
  regression_.Add(sensitivity, residual);
}

void ParallelPlant::Count(std::size_t signal, double residual) {
  Sum& sum = residual_[signal];
  sum.sum += residual;
  sum.squares += residual * residual;
  ++sum.count;
}

std::vector<DriftFigure> ParallelPlant::Drift() const {
  std::vector<DriftFigure> drift = regression_.Solve();
  drift.resize(channels_.size());  // without lag and offsets
  return drift;
}

std::vector<ResidualFigure> ParallelPlant::Residuals() const {
  std::vector<ResidualFigure> figures;
  for (std::size_t i = 0; i < residual_.size(); ++i) {
    const Sum& sum = residual_[i];
    const auto count = static_cast<double>(std::max<std::int64_t>(1, sum.count));
    const double noise = i < kCounters
                             ? std::hypot(count_rad_[i] / std::sqrt(12.0), angle_sigma_rad_[i])
                             : NoiseOf(sensors_, i - kCounters);
    figures.push_back(
        {.mean = sum.sum / count, .rms = std::sqrt(sum.squares / count), .noise = noise});
  }
  return figures;
}

}  // namespace flexarm
