#include "tools/identification/run_comparison.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "controller/runlog/csv_import.h"
#include "controller/runlog/errors.h"
#include "estimator/counter_decoder.h"
#include "hal/gauge_filter.h"
#include "model/arm/dc_motor.h"
#include "model/math/dense_decompositions.h"
#include "model/problem_list.h"
#include "model/simulation/arm_simulator.h"
#include "tools/runs/run_summary.h"

namespace flexarm {
namespace {

constexpr std::array<const char*, kCounters> kAngleNames = {"joint1", "joint2", "rotor1", "rotor2"};

// Signed counts per unit of strain.
double CountsPerUnit(const SensorConfig& sensors, const StrainChannelConfig& row) {
  return row.face * row.gain_v_per_unit / sensors.strain_input.volts_per_count();
}

// Maps the arm's coordinates (columns) to the counts of the strain channels above their offsets
// (rows).
Eigen::MatrixXd CountsOfCoordinates(const ArmModel& arm, const SensorConfig& sensors) {
  Eigen::MatrixXd counts(static_cast<Eigen::Index>(sensors.strain.size()), arm.dof());
  for (Eigen::Index j = 0; j < arm.dof(); ++j) {
    const Eigen::VectorXd unit = Eigen::VectorXd::Unit(arm.dof(), j);
    for (Eigen::Index i = 0; i < counts.rows(); ++i) {
      const StrainChannelConfig& row = sensors.strain[static_cast<std::size_t>(i)];
      counts(i, j) = CountsPerUnit(sensors, row) * arm.Strain(row.link, row.position_m, unit);
    }
  }
  return counts;
}

Eigen::VectorXd Offsets(const SensorConfig& sensors) {
  Eigen::VectorXd offset(static_cast<Eigen::Index>(sensors.strain.size()));
  for (Eigen::Index i = 0; i < offset.size(); ++i) {
    offset(i) = sensors.strain[static_cast<std::size_t>(i)].offset_counts;
  }
  return offset;
}

// Row l: the tip deflection of link l + 1 from counts above their offsets. Shapes have psi(L) = 1,
// so the tip moves by the sum of the modal coordinates.
Eigen::MatrixXd TipOfCounts(const RigConfig& config) {
  const int modes = config.estimator.modes_per_link;
  const ArmModel arm(config.arm, {.link1 = modes, .link2 = modes});
  const Eigen::MatrixXd counts = CountsOfCoordinates(arm, config.sensors);
  Eigen::MatrixXd tip = Eigen::MatrixXd::Zero(2, counts.rows());
  for (Eigen::Index link = 0; link < 2; ++link) {
    const Eigen::MatrixXd shape = counts.middleCols(kPhi1 + link * modes, modes);
    const Eigen::MatrixXd modal = shape.completeOrthogonalDecomposition().pseudoInverse();
    tip.row(link) = modal.colwise().sum();
  }
  return tip;
}

// The readings as they would be without the calibration from commissioning.
Eigen::VectorXd UncalibratedCounts(const StepInput& input, const Eigen::VectorXd& offset) {
  Eigen::VectorXd counts(offset.size());
  for (Eigen::Index i = 0; i < counts.size(); ++i) {
    const auto channel = static_cast<std::size_t>(i);
    const double zero = static_cast<double>(input.calibration.strain_zero_counts[channel]);
    const double error = static_cast<double>(input.calibration.strain_gain_error[channel]);
    counts(i) = offset(i) + (input.frame.strain[channel] - offset(i) - zero) / (1.0 + error);
  }
  return counts;
}

}  // namespace

RunComparison::RunComparison(std::filesystem::path file, const RigConfig& config, TimeSpan span)
    : file_(std::move(file)),
      span_(span),
      csv_(file_.extension() == ".csv"),
      csv_import_(config.csv),
      tip_of_counts_(TipOfCounts(config)),
      count_offset_(Offsets(config.sensors)) {
  input_ = Inputs(config);
  for (int i = 0; i < kCounters; ++i) {
    if ((config.sensors.counters_present() >> i & 1U) == 0) continue;
    signal_.push_back({kAngleNames[static_cast<std::size_t>(i)], true});
    counter_.push_back(i);
  }
  signal_.push_back({"link1", false});
  signal_.push_back({"link2", false});
  Measure(config);
  FormSpread();
}

std::vector<StepInput> RunComparison::Inputs(const RigConfig& config) const {
  if (csv_) {
    return ReadAnyCsv(file_, config.csv ? &*config.csv : nullptr, config.sensors,
                      config.loop.period_s())
        .input;
  }
  RunReader reader(file_);
  std::vector<StepInput> inputs;
  reader.ForEachTick([&](const TickRecord& record) { inputs.push_back(record.input); });
  return inputs;
}

void RunComparison::Measure(const RigConfig& config) {
  const auto angles = static_cast<Eigen::Index>(counter_.size());
  const double period_s = config.loop.period_s();
  const auto all = static_cast<Eigen::Index>(input_.size());
  measured_ = compared_ = Eigen::MatrixXd::Zero(all, angles + 2);
  time_s_ = Eigen::VectorXd::Zero(all);
  CounterDecoder decoder(config.sensors, period_s, config.estimator.max_joint_rate_rad_s);
  const std::uint64_t channels = (std::uint64_t{1} << config.sensors.strain.size()) - 1;
  for (Eigen::Index k = 0; k < all; ++k) {
    const StepInput& input = input_[static_cast<std::size_t>(k)];
    if (k == 0 || input.reset != 0) {
      decoder.Reset(input.counts_before, input.calibration.counter_zero);
    }
    const DecodedCounters decoded = decoder.Decode(input.frame);
    time_s_(k) = static_cast<double>(input.tick - input_.front().tick) * period_s;
    for (Eigen::Index i = 0; i < angles; ++i) {
      const auto counter = static_cast<std::size_t>(counter_[static_cast<std::size_t>(i)]);
      measured_(k, i) = decoded.angle_rad[counter];
      compared_(k, i) = (decoded.good >> counter & 1U) != 0 ? 1.0 : 0.0;
    }
    const Eigen::VectorXd bent = UncalibratedCounts(input, count_offset_) - count_offset_;
    measured_.row(k).tail<2>() = (tip_of_counts_ * bent).transpose();
    compared_.row(k).tail<2>().setConstant(input.frame.strain_valid == channels ? 1.0 : 0.0);
  }
  KeepSpan();
}

// Rows are in the order of time.
void RunComparison::KeepSpan() {
  const auto* begin = time_s_.data();
  const auto* end = begin + time_s_.size();
  first_ = std::lower_bound(begin, end, span_.from_s) - begin;
  const Eigen::Index count = std::upper_bound(begin, end, span_.until_s) - begin - first_;
  if (count < 2) {
    throw InputError(file_.string() + ": has fewer than 2 samples between the times given; it is " +
                     NumberText(time_s_(time_s_.size() - 1)) + " s long");
  }
  measured_ = measured_.middleRows(first_, count).eval();
  compared_ = compared_.middleRows(first_, count).eval();
  time_s_ = time_s_.segment(first_, count).eval();
  if (compared_.row(0).minCoeff() > 0.0) return;
  throw InputError(file_.string() + ": not every sensor is valid in the first sample, at " +
                   NumberText(time_s_(0)) + " s; the prediction starts from it");
}

void RunComparison::FormSpread() {
  spread_ = Eigen::VectorXd::Zero(measured_.cols());
  for (Eigen::Index i = 0; i < measured_.cols(); ++i) {
    const double count = compared_.col(i).sum();
    if (count < 2.0) {
      throw InputError(file_.string() + ": " + signal_[static_cast<std::size_t>(i)].name +
                       " has no valid samples to compare");
    }
    const double mean = compared_.col(i).dot(measured_.col(i)) / count;
    const Eigen::ArrayXd away = compared_.col(i).array() * (measured_.col(i).array() - mean);
    spread_(i) = std::sqrt(away.square().sum() / count);
    if (spread_(i) > 0.0) continue;
    throw InputError(file_.string() + ": " + signal_[static_cast<std::size_t>(i)].name +
                     " never changes; expected a run in which both joints and both links move");
  }
}

ArmState RunComparison::Start(int dof) const {
  ArmState state(dof);
  for (std::size_t i = 0; i < counter_.size(); ++i) {
    state.q(counter_[i]) = measured_(0, static_cast<Eigen::Index>(i));
    // A rotor without an encoder starts at the angle of its hub.
    if (counter_[i] < 2) state.q(counter_[i] + 2) = state.q(counter_[i]);
  }
  return state;
}

Eigen::MatrixXd RunComparison::Predict(const RigConfig& candidate) const {
  // The torques of a CSV file are converted by the candidate's scales and offsets.
  const std::vector<StepInput> own =
      csv_ && candidate.csv != csv_import_ ? Inputs(candidate) : std::vector<StepInput>();
  const std::vector<StepInput>& input = own.empty() ? input_ : own;
  const int modes = candidate.sim.plant_modes;
  const ArmModel arm(candidate.arm, {.link1 = modes, .link2 = modes});
  ArmSimulator simulator(arm);
  const Eigen::MatrixXd counts = CountsOfCoordinates(arm, candidate.sensors);
  const double step_s = candidate.sim.step_ms * 1e-3;
  const int steps = static_cast<int>(std::lround(candidate.loop.period_s() / step_s));
  GaugeFilter filter(candidate.sensors.strain_input, step_s, counts.rows());
  ArmState state = Start(arm.dof());
  const Eigen::VectorXd base = Offsets(candidate.sensors) - count_offset_;
  Eigen::MatrixXd predicted(measured_.rows(), measured_.cols());
  std::array<DcMotor, 2> motor;
  for (std::size_t i = 0; i < 2; ++i) {
    motor[i] = DcMotor(step_s, candidate.sim.motor_lag_ms[i] * 1e-3);
  }
  for (Eigen::Index row = 0; row < predicted.rows(); ++row) {
    const auto k = static_cast<std::size_t>(first_ + row);
    const std::int64_t periods = row == 0 ? 0 : input[k].tick - input[k - 1].tick;
    for (std::int64_t i = 0; i < periods * steps; ++i) {
      const std::array<double, 2>& applied_nm = input[k].applied_torque_nm;
      const Eigen::Vector2d torque(motor[0].Step(applied_nm[0]), motor[1].Step(applied_nm[1]));
      simulator.Step(state, torque, step_s);
      filter.Step(counts * state.q);
    }
    for (std::size_t i = 0; i < counter_.size(); ++i) {
      predicted(row, static_cast<Eigen::Index>(i)) = state.q(counter_[i]);
    }
    predicted.row(row).tail<2>() = (tip_of_counts_ * (filter.output() + base)).transpose();
  }
  return predicted;
}

Eigen::VectorXd FitPercent(const RunComparison& run, const Eigen::MatrixXd& predicted) {
  const Eigen::ArrayXXd error =
      run.compared().array() * (run.measured().array() - predicted.array());
  const Eigen::ArrayXd count = run.compared().colwise().sum().transpose();
  const Eigen::ArrayXd rms = (error.square().colwise().sum().transpose() / count).sqrt();
  return 100.0 * (1.0 - rms / run.spread().array());
}

}  // namespace flexarm
