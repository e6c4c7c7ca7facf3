#include "controller/commissioning/pluck_model.h"

#include <cmath>

#include "hal/gauge_filter.h"
#include "model/arm/arm_model.h"
#include "model/simulation/arm_simulator.h"

namespace flexarm {
namespace {

constexpr int kModes = 4;      // per link: error of 0.05 % in the arm's first four frequencies
constexpr int kBaseTicks = 5;  // samples at rest at the start

double UnitPerCount(const SensorConfig& sensors, std::size_t i, const Calibration& calibration) {
  const StrainChannelConfig& row = sensors.strain[i];
  return row.face * sensors.strain_input.volts_per_count() / row.gain_v_per_unit /
         (1.0 + static_cast<double>(calibration.strain_gain_error[i]));
}

// Rows: strain channels; columns: the arm's coordinates.
Eigen::MatrixXd StrainOfCoordinates(const ArmModel& arm, const SensorConfig& sensors) {
  Eigen::MatrixXd shape(static_cast<Eigen::Index>(sensors.strain.size()), arm.dof());
  for (Eigen::Index j = 0; j < arm.dof(); ++j) {
    const Eigen::VectorXd unit = Eigen::VectorXd::Unit(arm.dof(), j);
    for (Eigen::Index i = 0; i < shape.rows(); ++i) {
      const StrainChannelConfig& row = sensors.strain[static_cast<std::size_t>(i)];
      shape(i, j) = arm.Strain(row.link, row.position_m, unit);
    }
  }
  return shape;
}

}  // namespace

PluckMotion MeasuredMotion(const RigConfig& config, const std::vector<TickRecord>& run) {
  const auto channels = static_cast<Eigen::Index>(config.sensors.strain.size());
  PluckMotion motion(static_cast<Eigen::Index>(run.size()), kCounters + channels);
  for (Eigen::Index k = 0; k < motion.rows(); ++k) {
    const TickRecord& tick = run[static_cast<std::size_t>(k)];
    for (Eigen::Index i = 0; i < kCounters; ++i) {
      motion(k, i) = tick.output.angle_rad[static_cast<std::size_t>(i)];
    }
    for (Eigen::Index i = 0; i < channels; ++i) {
      const auto row = static_cast<std::size_t>(i);
      motion(k, kCounters + i) =
          tick.input.frame.strain[row] * UnitPerCount(config.sensors, row, tick.input.calibration);
    }
  }
  const Eigen::Index base = std::min<Eigen::Index>(kBaseTicks, motion.rows());
  if (base > 0) motion.rowwise() -= motion.topRows(base).colwise().mean().eval();
  return motion;
}

PluckMotion ExpectedMotion(const RigConfig& config, const std::vector<TickRecord>& run,
                           bool exchanged) {
  const ArmModel arm(config.arm, {.link1 = kModes, .link2 = kModes});
  ArmSimulator simulator(arm);
  const Eigen::MatrixXd strain = StrainOfCoordinates(arm, config.sensors);
  const double period_s = config.loop.period_s();
  const int steps = static_cast<int>(std::ceil(period_s / ArmSimulator::kDefaultStep_s));
  const double step_s = period_s / steps;
  GaugeFilter filter(config.sensors.strain_input, step_s, strain.rows());

  ArmState state(arm.dof());
  PluckMotion motion =
      PluckMotion::Zero(static_cast<Eigen::Index>(run.size()), kCounters + strain.rows());
  if (run.empty()) return motion;
  const double elbow_rad = run.front().output.angle_rad[1];
  state.q(1) = state.q(3) = elbow_rad;
  for (std::size_t k = 1; k < run.size(); ++k) {
    const std::array<double, 2>& applied = run[k].input.applied_torque_nm;
    const Eigen::Vector2d torque(applied[exchanged ? 1 : 0], applied[exchanged ? 0 : 1]);
    const auto periods = static_cast<int>(run[k].input.tick - run[k - 1].input.tick);
    for (int i = 0; i < periods * steps; ++i) {
      simulator.Step(state, torque, step_s);
      filter.Step(strain * state.q);
    }
    const auto row = static_cast<Eigen::Index>(k);
    motion.block<1, kCounters>(row, 0) = state.q.head<kCounters>().transpose();
    motion(row, 1) -= elbow_rad;
    motion(row, 3) -= elbow_rad;
    motion.row(row).tail(strain.rows()) = filter.output().transpose();
  }
  return motion;
}

}  // namespace flexarm
