#include "tools/csv/predicted_strain.h"

#include <algorithm>
#include <cmath>

#include "estimator/counter_decoder.h"
#include "estimator/nominal_model.h"
#include "model/math/dense_decompositions.h"
#include "model/math/discretize.h"
#include "model/units.h"

namespace flexarm {
namespace {

constexpr double kSmooth_s = 0.06;      // against the noise of accelerations
constexpr double kMovingCounts = 2.0;   // a period: a joint that moves less may stick
constexpr double kFrictionError = 0.3;  // of the Coulomb friction that the config states

double AngleOf(const DecodedCounters& decoded, std::size_t joint, std::uint32_t present) {
  const std::size_t rotor = joint + 2;
  return decoded.angle_rad[(present >> rotor & 1U) != 0 ? rotor : joint];
}

Signal Acceleration(const Signal& angle, double period_s) {
  Signal acceleration(angle.size());
  for (std::size_t k = 1; k + 1 < angle.size(); ++k) {
    acceleration[k] = (angle[k + 1] - 2.0 * angle[k] + angle[k - 1]) / (period_s * period_s);
  }
  return acceleration;
}

}  // namespace

JointMotion MotionOf(const RigConfig& config, const Calibration& calibration, const CsvRun& run) {
  JointMotion motion;
  CounterDecoder decoder(config.sensors, config.loop.period_s(),
                         config.estimator.max_joint_rate_rad_s);
  decoder.Reset(run.input.front().counts_before, calibration.counter_zero);
  const std::uint32_t present = config.sensors.counters_present();
  for (const StepInput& input : run.input) {
    const DecodedCounters decoded = decoder.Decode(input.frame);
    for (std::size_t joint = 0; joint < 2; ++joint) {
      motion.angle_rad[joint].push_back(AngleOf(decoded, joint, present));
    }
    motion.read.push_back((decoded.good & present) == present);
  }
  return motion;
}

std::size_t HalfWindow(double period_s) {
  return static_cast<std::size_t>(std::lround(0.5 * kSmooth_s / period_s));
}

RootMoment RootMomentOf(std::size_t joint, const RigConfig& config, const CsvRun& run,
                        const JointMotion& motion) {
  const JointParameters& parameters = config.arm.joint[joint];
  const double period_s = config.loop.period_s();
  const double inertia = parameters.rotor_inertia_kgm2 + parameters.hub_inertia_kgm2;
  double rad_per_count = 0.0;
  for (const EncoderConfig& encoder : config.sensors.encoder) {
    if (static_cast<std::size_t>(encoder.counter) % 2 == joint) {
      rad_per_count = std::max(rad_per_count, kTwoPi / encoder.counts_per_turn);
    }
  }
  const double slow_rad_s = kMovingCounts * rad_per_count / period_s;
  const Signal& angle = motion.angle_rad[joint];
  const std::size_t samples = angle.size();
  const double window = 2.0 * static_cast<double>(HalfWindow(period_s)) + 1.0;
  RootMoment out{.moment_nm = Signal(samples),
                 .known = std::vector<bool>(samples),
                 .noise_nm = std::hypot(
                     kFrictionError * parameters.coulomb_friction_nm,
                     inertia * rad_per_count / (std::sqrt(3.0) * window * period_s * period_s))};
  const Signal acceleration = Acceleration(angle, period_s);
  for (std::size_t k = 1; k + 1 < samples; ++k) {
    const double rate = (angle[k + 1] - angle[k - 1]) / (2.0 * period_s);
    const double torque =
        0.5 * (run.input[k].applied_torque_nm[joint] + run.input[k + 1].applied_torque_nm[joint]);
    out.moment_nm[k] = torque - std::copysign(parameters.coulomb_friction_nm, rate) -
                       parameters.viscous_friction_nm_s_per_rad * rate - inertia * acceleration[k];
    out.known[k] =
        motion.read[k - 1] && motion.read[k] && motion.read[k + 1] && std::abs(rate) > slow_rad_s;
  }
  return out;
}

std::vector<Eigen::VectorXd> BaseDrivenModes(const RigConfig& config, double payload_kg,
                                             const JointMotion& motion) {
  ArmParameters arm = config.arm;
  arm.payload_mass_kg = payload_kg;
  const int modes = config.controller.nominal.modes_per_link;
  const NominalModel model = MakeNominalModel(arm, {.torsion = false, .modes_per_link = modes});
  const Eigen::Index flex = Eigen::Index{2} * modes;
  // f'' = -M_ff^-1 (D_ff f' + K_ff f + M_f th'')
  const Eigen::LLT<Eigen::MatrixXd> mass(Eigen::MatrixXd(model.M.bottomRightCorner(flex, flex)));
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(2 * flex, 2 * flex);
  A.topRightCorner(flex, flex).setIdentity();
  A.bottomLeftCorner(flex, flex) =
      -mass.solve(Eigen::MatrixXd(model.K.bottomRightCorner(flex, flex)));
  A.bottomRightCorner(flex, flex) =
      -mass.solve(Eigen::MatrixXd(model.D.bottomRightCorner(flex, flex)));
  Eigen::MatrixXd B = Eigen::MatrixXd::Zero(2 * flex, 2);
  B.bottomRows(flex) = -mass.solve(Eigen::MatrixXd(model.M.bottomLeftCorner(flex, 2)));
  const double period_s = config.loop.period_s();
  const DiscreteModel step = ZeroOrderHold(A, B, period_s);
  const std::array<Signal, 2> acceleration = {Acceleration(motion.angle_rad[0], period_s),
                                              Acceleration(motion.angle_rad[1], period_s)};
  std::vector<Eigen::VectorXd> f;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(2 * flex);
  for (std::size_t k = 0; k < motion.read.size(); ++k) {
    if (k > 0) {
      const Eigen::Vector2d held(0.5 * (acceleration[0][k - 1] + acceleration[0][k]),
                                 0.5 * (acceleration[1][k - 1] + acceleration[1][k]));
      x = (step.A * x + step.B * held).eval();
    }
    f.emplace_back(x.head(flex));
  }
  return f;
}

Signal BehindGaugeFilter(const Signal& signal, const StrainInputConfig& input, double period_s) {
  const double w = kTwoPi * input.filter_hz;
  if (!(w > 0.0) || signal.empty()) return signal;
  Eigen::MatrixXd A(1, 1), B(1, 1);
  if (input.filter_damping > 0.0) {
    A = Eigen::MatrixXd::Zero(2, 2);
    A << 0.0, 1.0, -w * w, -2.0 * input.filter_damping * w;
    B = Eigen::MatrixXd::Zero(2, 1);
    B(1, 0) = w * w;
  } else {
    A(0, 0) = -w;
    B(0, 0) = w;
  }
  const DiscreteModel step = ZeroOrderHold(A, B, period_s);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(A.rows());
  x(0) = signal.front();
  Signal filtered = {signal.front()};
  for (std::size_t k = 1; k < signal.size(); ++k) {
    x = (step.A * x + step.B.col(0) * (0.5 * (signal[k - 1] + signal[k]))).eval();
    filtered.push_back(x(0));
  }
  return filtered;
}

Signal Smoothed(const Signal& signal, double period_s) {
  const std::size_t half = HalfWindow(period_s);
  Signal smooth(signal.size());
  for (std::size_t k = half; k + half < signal.size(); ++k) {
    double sum = 0.0;
    for (std::size_t i = k - half; i <= k + half; ++i) sum += signal[i];
    smooth[k] = sum / static_cast<double>(2 * half + 1);
  }
  return smooth;
}

}  // namespace flexarm
