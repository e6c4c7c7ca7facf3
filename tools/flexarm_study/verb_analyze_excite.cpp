#include <CLI/CLI.hpp>
#include <array>
#include <iomanip>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "controller/files/external_json.h"
#include "model/simulation/arm_simulator.h"
#include "tools/analysis/excitation_run.h"
#include "tools/command_line/options.h"
#include "tools/command_line/verbs.h"
#include "tools/plot/gnuplot.h"

namespace flexarm {
namespace {

struct ExciteOptions {
  ConfigOptions config;
  int modes = 4;
  double theta2_deg = 0.0;
  Excitation excitation;
  std::optional<std::array<double, 2>> torque_nm, motor_lag_ms;  // empty: the config's
  double duration_s = 3.0;
  bool without_dissipation = false;
  bool json = false;
  OutputOptions output;
};

ExcitationRun RunOf(ExciteOptions& options) {
  const RigConfig config = options.config.Load();
  ArmParameters arm = config.arm;
  options.excitation = ExcitationFor(config);
  if (options.torque_nm) options.excitation.torque_nm = *options.torque_nm;
  if (options.motor_lag_ms) options.excitation.motor_lag_ms = *options.motor_lag_ms;
  if (options.without_dissipation) {
    arm.damping = DampingReading::kNone;
    for (JointParameters& joint : arm.joint) joint.coulomb_friction_nm = 0.0;
  }
  return RunExcitation(ArmModel(arm, {options.modes, options.modes}), options.theta2_deg,
                       options.excitation, options.duration_s);
}

nlohmann::ordered_json ToJson(const ExciteOptions& options, const ExcitationRun& run) {
  return {{"torque_nm", options.excitation.torque_nm},
          {"motor_lag_ms", options.excitation.motor_lag_ms},
          {"duration_s", options.duration_s},
          {"modes", options.modes},
          {"peak_bending_mm", run.peak_bending_mm},
          {"final_joint_deg", run.sample.back().joint_deg},
          {"final_tip_m", std::array{run.tip_m.x(), run.tip_m.y()}}};
}

void Excite(ExciteOptions& options) {
  if (options.output.given())
    CheckPicture(options.output.file,
                 PictureRules({options.config.file}, options.output.overwrite));
  const ExcitationRun run = RunOf(options);
  if (options.output.given()) {
    DrawExcitation(run, options.output.file,
                   PictureRules({options.config.file}, options.output.overwrite));
    ReportWritten(options.output.file);
  }
  const nlohmann::ordered_json json = ToJson(options, run);
  if (options.json) {
    std::cout << PrintedJson(json) << '\n';
    return;
  }
  std::cout << std::setprecision(6) << "largest bending, mm: " << run.peak_bending_mm[0] << ' '
            << run.peak_bending_mm[1] << "\ntip after " << options.duration_s
            << " s, m: " << run.tip_m.x() << ' ' << run.tip_m.y() << '\n';
}

}  // namespace

void RegisterAnalyzeExcite(CLI::App& analyze, Exit&) {
  const auto options = std::make_shared<ExciteOptions>();
  CLI::App* verb = analyze.add_subcommand(
      "excite", "Simulate the free arm under one period of a square wave of torque (chapter 4)");
  options->config.AddTo(verb, true);
  verb->add_option("--modes", options->modes, "Bending modes a link")
      ->check(CLI::Range(1, kMaxSteppedModes))
      ->capture_default_str();
  verb->add_option("--theta2-deg", options->theta2_deg, "Elbow angle at the start")
      ->check(NumberWithin(-180.0, 180.0))
      ->capture_default_str();
  verb->add_option("--torque-nm", options->torque_nm,
                   "Amplitudes of the motor torques (default: 1/75 and 1/60 of the torque limits)")
      ->check(NumberWithin(-1e4, 1e4))
      ->type_name("TAU1 TAU2");
  verb->add_option("--motor-lag-ms", options->motor_lag_ms,
                   "Time constants of the motors' torques (3.24) (default: sim.motor_lag_ms)")
      ->check(NumberWithin(0.0, 1000.0))
      ->type_name("T1 T2");
  verb->add_option("--duration-s", options->duration_s, "Length of the run")
      ->check(NumberWithin(0.01, 600.0))
      ->capture_default_str();
  verb->add_flag("--without-dissipation", options->without_dissipation,
                 "Leave out dry friction and the links' damping");
  AddJson(verb, &options->json);
  options->output.AddTo(
      verb, "Picture of bending and joint angles, .png or .svg (figures 4.4 and 4.5)", false);
  verb->footer(
      "Prints the largest bending of the links and the final position of the tip. The wave has a\n"
      "period of 1 s; the thesis does not state its amplitude.\n"
      "Example: flexarm analyze excite -c config/thesis-rig.toml -o square-wave.png");
  verb->callback([options] { Excite(*options); });
}

}  // namespace flexarm
