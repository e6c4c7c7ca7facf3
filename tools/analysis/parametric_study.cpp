#include "tools/analysis/parametric_study.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "config/thesis_arm.h"
#include "model/arm/dc_motor.h"
#include "model/arm/linearization.h"
#include "model/simulation/arm_simulator.h"
#include "model/units.h"
#include "tools/support/parallel_for.h"

namespace flexarm {
namespace {

constexpr double kSample_s = 2e-3;
constexpr std::size_t kSpectrumSamples = 4096;  // 8.192 s: lines 0.24 Hz wide
constexpr std::size_t kExcitedSamples = 500;    // Excitation::kPeriod_s
constexpr std::size_t kSamples = kExcitedSamples + kSpectrumSamples;
constexpr double kLowest_hz =
    0.3;  // slower components are the rigid-body motion of the arm coming to rest

struct SweepPlan {
  std::string name, label;
  double nominal;
  std::vector<double> values;
  std::function<void(ArmParameters*, double)> apply;
};

using Samples = std::array<std::vector<double>, kSignals>;

std::vector<double> Multiples(double unit, std::vector<double> factors) {
  for (double& factor : factors) factor *= unit;
  return factors;
}

// Rounded lengths from half to one and a half times the nominal one.
std::vector<double> Lengths(double nominal) {
  const double magnitude = std::pow(10.0, std::floor(std::log10(nominal / 8.0)));
  const double step = std::round(nominal / 8.0 / magnitude) * magnitude;
  std::vector<double> values;
  for (double i = std::ceil(0.5 * nominal / step - 1e-9); i * step <= 1.5 * nominal + 1e-9; ++i) {
    values.push_back(i * step);
  }
  return values;
}

SweepPlan StiffnessPlan(const ArmParameters& arm, std::size_t joint) {
  const std::string number = std::to_string(joint + 1);
  const double nominal = arm.joint[joint].stiffness_nm_per_rad;
  return {
      "joint" + number + "_stiffness_nm_per_rad", "stiffness of joint " + number + ", N m/rad",
      nominal, Multiples(nominal, {0.25, 0.35, 0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0}),
      [joint](ArmParameters* p, double value) { p->joint[joint].stiffness_nm_per_rad = value; }};
}

SweepPlan LengthPlan(const ArmParameters& arm, std::size_t link) {
  const std::string number = std::to_string(link + 1);
  const double nominal = arm.link[link].length_m();
  return {"link" + number + "_length_m", "length of link " + number + ", m", nominal,
          Lengths(nominal), [link, nominal](ArmParameters* p, double value) {
            for (BeamSection& s : p->link[link].section) s.length_m *= value / nominal;
          }};
}

SweepPlan BacklashPlan(const ArmParameters& arm, BacklashModel model, const char* name,
                       const char* label) {
  return {name,
          label,
          arm.joint2_backlash.clearance_rad / kRadPerDeg,
          {0.0, 0.05, 0.1, 0.15, 0.2, 0.3, 0.5, 1.0, 2.0, 3.0, 5.0},
          [model](ArmParameters* p, double value) {
            p->joint2_backlash.model = model;
            p->joint2_backlash.clearance_rad = value * kRadPerDeg;
          }};
}

// From the least to the greatest payload of the rig; to twice the nominal one if there is one only.
std::vector<double> Payloads_kg(const RigConfig& config) {
  auto [least, most] = config.controller.payload_range_kg;
  if (!(most > least)) most = least + std::max(config.arm.payload_mass_kg, 0.01);
  constexpr int kSteps = 10;
  constexpr double kMilligrams = 1e6;
  std::vector<double> values;
  for (int i = 0; i <= kSteps; ++i) {
    const double kg = least + (most - least) * i / kSteps;
    values.push_back(std::round(kMilligrams * kg) / kMilligrams);
  }
  return values;
}

std::vector<SweepPlan> AllPlans(const RigConfig& config) {
  const ArmParameters& arm = config.arm;
  return {{"payload_kg", "payload, kg", arm.payload_mass_kg, Payloads_kg(config),
           [](ArmParameters* p, double value) {
             p->payload_mass_kg = p->shape_payload_mass_kg = value;
           }},
          StiffnessPlan(arm, 0),
          StiffnessPlan(arm, 1),
          {"friction_factor",
           "joint friction, times the rig's",
           1.0,
           {0.0, 0.1, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0},
           [](ArmParameters* p, double value) {
             for (JointParameters& joint : p->joint) joint.coulomb_friction_nm *= value;
           }},
          BacklashPlan(arm, BacklashModel::kDeadZone, "backlash_deg", "backlash of joint 2, deg"),
          BacklashPlan(arm, BacklashModel::kThesis, "thesis_backlash_deg",
                       "backlash of joint 2 in the thesis's form, deg"),
          LengthPlan(arm, 0),
          LengthPlan(arm, 1)};
}

std::vector<SweepPlan> Plans(const RigConfig& config) {
  std::vector<SweepPlan> plans = AllPlans(config);
  if (!IsThesisArm(config.arm)) plans.erase(plans.begin() + kThesisBacklash);
  return plans;
}

Samples Respond(const RigConfig& config, const ArmModel& model, const Excitation& excitation) {
  ArmSimulator simulator(
      model, {.substeps = std::max(
                  1, static_cast<int>(std::ceil(1e3 * kSample_s / config.sim.step_ms - 1e-9)))});
  ArmState x(model.dof());
  const ArmConstants& c = model.constants();
  Samples samples;
  DcMotor motor1(kSample_s, 1e-3 * excitation.motor_lag_ms[0]);
  DcMotor motor2(kSample_s, 1e-3 * excitation.motor_lag_ms[1]);
  for (std::size_t k = 0; k < kSamples; ++k) {
    const double sign = k < kExcitedSamples / 2 ? 1.0 : k < kExcitedSamples ? -1.0 : 0.0;
    const double torque1 = motor1.Step(sign * excitation.torque_nm[0]);
    const double torque2 = motor2.Step(sign * excitation.torque_nm[1]);
    simulator.Step(x, {torque1, torque2}, kSample_s);
    samples[kBending1].push_back(1e3 * c.link1.psi_tip.dot(x.q.segment(kPhi1, c.m1)));
    samples[kBending2].push_back(1e3 * c.link2.psi_tip.dot(x.q.tail(c.m2)));
    samples[kTwist1].push_back(1e3 * (x.q[kTheta3] - x.q[kTheta1]));
    samples[kTwist2].push_back(1e3 * (x.q[kTheta4] - x.q[kTheta2]));
  }
  return samples;
}

// For a run that diverged: the thesis's form of backlash can add energy to the arm.
SignalMeasures Diverged() {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  const Spectrum nothing = AmplitudeSpectrum(std::vector<double>(kSpectrumSamples), kSample_s);
  return {kInfinite, kInfinite, kInfinite, kInfinite, nothing};
}

SignalMeasures Measure(const std::vector<double>& values) {
  const auto finite = [](double value) { return std::isfinite(value); };
  if (!std::all_of(values.begin(), values.end(), finite)) return Diverged();
  SignalMeasures out{};
  for (const double value : values) out.peak = std::max(out.peak, std::abs(value));
  const std::vector<double> whole(values.begin(), values.begin() + kSpectrumSamples);
  const std::vector<double> free(values.begin() + kExcitedSamples, values.end());
  const double mean = std::accumulate(free.begin(), free.end(), 0.0) / kSpectrumSamples;
  for (const double value : free) out.free_rms += (value - mean) * (value - mean);
  out.free_rms = std::sqrt(out.free_rms / kSpectrumSamples);
  out.free_frequency_hz = DominantFrequencyHz(AmplitudeSpectrum(free, kSample_s), kLowest_hz);
  out.spectrum = AmplitudeSpectrum(whole, kSample_s);
  out.spectral_peak = out.spectrum.amplitude[out.spectrum.Largest(kLowest_hz)];
  out.spectrum.amplitude.resize(static_cast<std::size_t>(kShown_hz / out.spectrum.step_hz) + 1);
  return out;
}

ParametricPoint Run(const RigConfig& config, const SweepPlan& plan, double value,
                    const Excitation& excitation) {
  ArmParameters arm = config.arm;
  plan.apply(&arm, value);
  const int modes = config.sim.plant_modes;
  const ArmModel model(arm, {modes, modes});
  ParametricPoint point{value, {}, {}, 0.0};
  const Samples samples = Respond(config, model, excitation);
  for (std::size_t i = 0; i < kSignals; ++i) point.signal[i] = Measure(samples[i]);
  const Eigen::VectorXd free_hz = FreeMotorFrequenciesHz(model, 0.0);
  point.free_hz = {free_hz[0], free_hz[1]};
  point.held_hz = HeldMotorFrequenciesHz(model, 0.0)[0];
  return point;
}

}  // namespace

std::size_t ParametricRuns(const RigConfig& config) {
  std::size_t runs = 0;
  for (const SweepPlan& plan : Plans(config)) runs += plan.values.size();
  return runs;
}

Excitation ExcitationFor(const RigConfig& config) {
  Excitation excitation;
  excitation.motor_lag_ms = config.sim.motor_lag_ms;
  if (IsThesisArm(config.arm)) return excitation;
  constexpr std::array<double, 2> kThesisLimit_nm = {30.0, 6.0};
  for (std::size_t i = 0; i < 2; ++i) {
    excitation.torque_nm[i] *= config.safety.torque_limit_nm[i] / kThesisLimit_nm[i];
  }
  return excitation;
}

Excitation Strong(const Excitation& weak) {
  Excitation strong = weak;
  for (double& torque : strong.torque_nm) torque *= kStrongExcitation;
  return strong;
}

ParametricStudy RunParametricStudy(const RigConfig& config, const Excitation& excitation,
                                   const std::function<void(std::size_t)>& progress) {
  const std::vector<SweepPlan> plans = Plans(config);
  ParametricStudy study{excitation, {}};
  std::vector<std::pair<std::size_t, std::size_t>> runs;
  for (const SweepPlan& plan : plans) {
    for (std::size_t i = 0; i < plan.values.size(); ++i) runs.emplace_back(study.sweep.size(), i);
    study.sweep.push_back(
        {plan.name, plan.label, plan.nominal, std::vector<ParametricPoint>(plan.values.size())});
  }
  ParallelFor(
      runs.size(),
      [&](std::size_t run) {
        const auto [sweep, i] = runs[run];
        study.sweep[sweep].point[i] = Run(config, plans[sweep], plans[sweep].values[i], excitation);
      },
      progress);
  return study;
}

}  // namespace flexarm
