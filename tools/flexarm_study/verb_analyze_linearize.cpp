#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <iomanip>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "controller/files/external_json.h"
#include "controller/runlog/errors.h"
#include "model/arm/linearization.h"
#include "model/math/dense_decompositions.h"
#include "model/math/invariant_zeros.h"
#include "model/perturbation/perturbation_run.h"
#include "model/simulation/arm_simulator.h"
#include "model/units.h"
#include "tools/analysis/arm_zeros.h"
#include "tools/analysis/parametric_study.h"
#include "tools/analysis/perturbation_figures.h"
#include "tools/command_line/options.h"
#include "tools/command_line/verbs.h"
#include "tools/plot/gnuplot.h"

namespace flexarm {
namespace {

using Eigen::Vector2d;
using Eigen::VectorXd;

struct LinearizeOptions {
  ConfigOptions config;
  int modes = 4;
  double theta2_deg = 0.0, theta1_rate_rad_s = 0.0, theta2_rate_rad_s = 0.0;
  std::array<double, 2> torque_nm = {0.0, 0.0};
  double friction_gain_s_per_rad = 0.0;
  std::optional<std::array<double, 2>> delta;  // empty: the config's
  std::array<double, 2> delta_nm = {0.05, 0.0125};
  double duration_s = 2.0;
  bool json = false;
  OutputOptions output;
};

struct State {
  VectorXd q, v;
};

// An eighth of the excitation of chapter 4.
std::array<double, 2> SmallTorque_nm(const RigConfig& config) {
  const Excitation excitation = ExcitationFor(config);
  return {excitation.torque_nm[0] / 8.0, excitation.torque_nm[1] / 8.0};
}

// The links are not bent, the rotors stand at the angles of their hubs.
State StateOf(const LinearizeOptions& options, const ArmModel& model) {
  State x{VectorXd::Zero(model.dof()), VectorXd::Zero(model.dof())};
  x.q[kTheta2] = x.q[kTheta4] = options.theta2_deg * kRadPerDeg;
  x.v[kTheta1] = x.v[kTheta3] = options.theta1_rate_rad_s;
  x.v[kTheta2] = x.v[kTheta4] = options.theta2_rate_rad_s;
  return x;
}

nlohmann::ordered_json MatrixJson(const Eigen::MatrixXd& matrix) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    const VectorXd row = matrix.row(i);
    rows.push_back(std::vector<double>(row.begin(), row.end()));
  }
  return rows;
}

// One entry per real root or conjugate pair, in the order of their distance from zero.
nlohmann::ordered_json RootsJson(const Eigen::VectorXcd& values) {
  std::vector<std::complex<double>> roots(values.begin(), values.end());
  std::erase_if(roots, [](const auto& root) { return root.imag() < 0.0; });
  std::sort(roots.begin(), roots.end(),
            [](const auto& a, const auto& b) { return std::abs(a) < std::abs(b); });
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const auto& root : roots) {
    json.push_back({{"real_1_s", root.real()},
                    {"imaginary_rad_s", root.imag()},
                    {"frequency_hz", std::abs(root) / kTwoPi},
                    {"damping_ratio", std::abs(root) > 0.0 ? -root.real() / std::abs(root) : 0.0}});
  }
  return json;
}

nlohmann::ordered_json ZerosJson(const ArmModel& model, const LinearModel& linear, const State& x) {
  nlohmann::ordered_json json;
  for (const OutputZeros& outputs : ArmZeros(model, linear, x.q)) {
    if (!outputs.defined) {
      json[outputs.name] = nullptr;
      continue;
    }
    json[outputs.name] = {{"right_half_plane", outputs.unstable()},
                          {"minimum_phase", outputs.unstable() == 0},
                          {"zeros", RootsJson(outputs.zeros)}};
  }
  return json;
}

// Figures 6.1 and 6.2: the deltas as a square wave of 1 s period, one period long.
PerturbationRun PerturbationOf(const LinearizeOptions& options, const ArmModel& model,
                               const State& x) {
  Vector2d torque(options.torque_nm[0], options.torque_nm[1]);
  const Vector2d delta(options.delta_nm[0], options.delta_nm[1]);
  const auto wave = [delta](double t) {
    const double sign = t < 0.5 ? 1.0 : t < 1.0 ? -1.0 : 0.0;
    return Vector2d(sign * delta);
  };
  return Perturb(
      model, x.q, x.v, [torque](double) { return torque; }, wave, options.duration_s,
      ArmSimulator::kDefaultStep_s);
}

nlohmann::ordered_json PerturbationJson(const LinearizeOptions& options, const ArmModel& model,
                                        const PerturbationRun& run) {
  nlohmann::ordered_json json;
  json["delta_torque_nm"] = options.delta_nm;
  json["duration_s"] = options.duration_s;
  json["relative_error"] = {{"theta1", run.RelativeError(kTheta1)},
                            {"theta2", run.RelativeError(kTheta2)},
                            {"phi_11", run.RelativeError(kPhi1)},
                            {"phi_21", run.RelativeError(model.constants().phi2())}};
  return json;
}

nlohmann::ordered_json LinearJson(const LinearizeOptions& options, const ArmModel& model,
                                  const State& x) {
  const LinearModel linear =
      Linearize(model, x.q, x.v, Vector2d(options.torque_nm[0], options.torque_nm[1]),
                options.friction_gain_s_per_rad);
  nlohmann::ordered_json json;
  json["state"] = {{"theta2_deg", options.theta2_deg},
                   {"theta1_rate_rad_s", options.theta1_rate_rad_s},
                   {"theta2_rate_rad_s", options.theta2_rate_rad_s},
                   {"torque_nm", options.torque_nm}};
  json["modes"] = options.modes;
  json["foreshortening"] = model.constants().foreshortening;
  json["friction_gain_s_per_rad"] = options.friction_gain_s_per_rad;
  json["roots"] = RootsJson(linear.A.eigenvalues());
  const Integrators origin = CountIntegrators(linear.A);
  json["poles_at_origin"] = {{"count", origin.poles}, {"chains", origin.chains}};
  json["zeros"] = ZerosJson(model, linear, x);
  json["largest_real_part_1_s"] = linear.A.eigenvalues().real().maxCoeff();
  json["A"] = MatrixJson(linear.A);
  json["B"] = MatrixJson(linear.B);
  return json;
}

void PrintZeros(const nlohmann::ordered_json& json) {
  const auto& origin = json["poles_at_origin"];
  std::cout
      << "poles at the origin: " << origin["count"].get<int>() << ", in "
      << origin["chains"].get<int>() << " chains of integrators\n"
      << "zeros from the torques to: in the right half plane, of all; its nearest to 0, 1/s\n";
  for (const auto& [name, outputs] : json["zeros"].items()) {
    std::cout << "  " << std::left << std::setw(12) << name << std::right;
    if (outputs.is_null()) {
      std::cout << "undefined with a straight elbow\n";
      continue;
    }
    int all = 0;
    nlohmann::ordered_json nearest;
    for (const auto& zero : outputs["zeros"]) {
      all += zero["imaginary_rad_s"].get<double>() > 0.0 ? 2 : 1;
      if (nearest.is_null() && zero["real_1_s"].get<double>() > 0.0) nearest = zero;
    }
    std::cout << std::setw(4) << outputs["right_half_plane"].get<int>() << " of " << all;
    if (outputs["right_half_plane"].get<int>() > 0) {
      std::cout << "; " << nearest["real_1_s"].get<double>() << " + "
                << nearest["imaginary_rad_s"].get<double>() << " i";
    }
    std::cout << '\n';
  }
}

void PrintLinearization(const nlohmann::ordered_json& json) {
  std::cout << "roots of the linearised arm\n"
            << std::setprecision(5) << std::setw(14) << "real, 1/s" << std::setw(14)
            << "imag, rad/s" << std::setw(12) << "Hz" << std::setw(12) << "damping" << '\n';
  for (const auto& root : json["roots"]) {
    std::cout << std::setw(14) << root["real_1_s"].get<double>() << std::setw(14)
              << root["imaginary_rad_s"].get<double>() << std::setw(12)
              << root["frequency_hz"].get<double>() << std::setw(12)
              << root["damping_ratio"].get<double>() << '\n';
  }
  PrintZeros(json);
  std::cout << "perturbation by a square wave, linear against nonlinear: largest error / largest "
               "deviation\n";
  for (const auto& [name, error] : json["perturbation"]["relative_error"].items()) {
    std::cout << "  " << std::left << std::setw(18) << name << std::right << error.get<double>()
              << '\n';
  }
}

void Run(LinearizeOptions& options) {
  if (options.output.given())
    CheckPicture(options.output.file,
                 PictureRules({options.config.file}, options.output.overwrite));
  const RigConfig config = options.config.Load();
  options.delta_nm = options.delta.value_or(SmallTorque_nm(config));
  const ArmModel model(config.arm, {options.modes, options.modes});
  const State x = StateOf(options, model);
  nlohmann::ordered_json json = LinearJson(options, model, x);
  const PerturbationRun run = PerturbationOf(options, model, x);
  json["perturbation"] = PerturbationJson(options, model, run);
  if (options.output.given()) {
    DrawPerturbation(model, run, options.output.file,
                     PictureRules({options.config.file}, options.output.overwrite));
    ReportWritten(options.output.file);
  }
  if (options.json) {
    std::cout << PrintedJson(json) << '\n';
  } else {
    PrintLinearization(json);
  }
}

void AddState(CLI::App* verb, LinearizeOptions* options) {
  verb->add_option("--modes", options->modes, "Bending modes a link")
      ->check(CLI::Range(1, kMaxSteppedModes))
      ->capture_default_str();
  verb->add_option("--theta2-deg", options->theta2_deg, "Elbow angle")
      ->check(NumberWithin(-180.0, 180.0))
      ->capture_default_str();
  verb->add_option("--theta1-rate", options->theta1_rate_rad_s, "Rate of joint 1, rad/s")
      ->check(NumberWithin(-100.0, 100.0))
      ->capture_default_str();
  verb->add_option("--theta2-rate", options->theta2_rate_rad_s, "Rate of joint 2, rad/s")
      ->check(NumberWithin(-100.0, 100.0))
      ->capture_default_str();
  verb->add_option("--torque-nm", options->torque_nm, "Motor torques")
      ->check(NumberWithin(-1e4, 1e4))
      ->type_name("TAU1 TAU2");
  verb->add_option("--friction-gain", options->friction_gain_s_per_rad,
                   "Friction smoothed to K_F tanh(gain * rate), s/rad; 0: left out")
      ->check(NumberWithin(0.0, 1e6))
      ->capture_default_str();
}

}  // namespace

void RegisterAnalyzeLinearize(CLI::App& analyze, Exit&) {
  const auto options = std::make_shared<LinearizeOptions>();
  CLI::App* verb = analyze.add_subcommand(
      "linearize",
      "Linearize the model at a state: its roots, and its error against the nonlinear model");
  options->config.AddTo(verb, true);
  AddState(verb, options.get());
  verb->add_option(
          "--delta-nm", options->delta,
          "Torques of the perturbation test (default: 1/600 and 1/480 of the torque limits)")
      ->check(NumberWithin(-1e4, 1e4))
      ->type_name("TAU1 TAU2");
  verb->add_option("--duration-s", options->duration_s, "Length of the perturbation test")
      ->check(NumberWithin(0.01, 60.0))
      ->capture_default_str();
  AddJson(verb, &options->json);
  options->output.AddTo(
      verb, "Picture of the perturbation test, .png or .svg (thesis's figures 6.1 and 6.2)", false);
  verb->footer(
      "Zeros: of the motors' torques on two outputs: the rotors' angles, the hubs' angles, the\n"
      "directions of the links' ends as seen from their roots, the tip's position. A zero in the\n"
      "right half plane means non-minimum phase.\n"
      "At the state the links are not bent and the rotors stand at the angles of their hubs. The\n"
      "perturbation test simulates the arm from there without friction, with the given torques\n"
      "and with a small square wave added to them. It compares the difference of the two motions\n"
      "with the linear model along the first motion, driven by the wave alone.\n"
      "Example: flexarm analyze linearize -c config/thesis-rig.toml --theta2-deg 45 --theta1-rate "
      "1");
  verb->callback([options] { Run(*options); });
}

}  // namespace flexarm
