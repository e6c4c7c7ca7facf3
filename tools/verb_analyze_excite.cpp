#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "model/arm_simulator.h"
#include "tools/analysis/parametric_study.h"
#include "tools/gnuplot.h"
#include "tools/options.h"
#include "tools/verbs.h"

namespace flexarm {
namespace {

constexpr double kDegPerRad = 57.295779513082320877;

struct Options {
  ConfigOptions config;
  int modes = 4;
  double theta2_deg = 0.0;
  Excitation excitation;
  double duration_s = 3.0;
  bool without_dissipation = false;
  bool json = false;
  std::filesystem::path output;
};

struct Sample {
  double time_s;
  std::array<double, 2> bending_mm, joint_deg;
};

struct Run {
  std::vector<Sample> sample;
  std::array<double, 2> peak_bending_mm = {0.0, 0.0};
  Eigen::Vector2d tip_m;  // at the end
};

Sample SampleOf(const ArmModel& model, const ArmState& x, double time_s) {
  return {time_s,
          {1e3 * x.q.segment(kPhi1, model.mode_count().link1).sum(),
           1e3 * x.q.tail(model.mode_count().link2).sum()},
          {kDegPerRad * x.q[kTheta1], kDegPerRad * x.q[kTheta2]}};
}

Run RunOf(const Options& options) {
  ArmParameters arm = options.config.Load().arm;
  if (options.without_dissipation) {
    arm.damping = DampingReading::kNone;
    for (JointParameters& joint : arm.joint) joint.coulomb_friction_nm = 0.0;
  }
  const ArmModel model(arm, {options.modes, options.modes});
  ArmSimulator simulator(model);
  ArmState x(model.dof());
  x.q[kTheta2] = x.q[kTheta4] = options.theta2_deg / kDegPerRad;
  const Eigen::Vector2d torque(options.excitation.torque_nm[0], options.excitation.torque_nm[1]);
  const double h = ArmSimulator::kDefaultStep_s;
  const auto steps = std::lround(options.duration_s / h);
  Run run;
  run.sample.push_back(SampleOf(model, x, 0.0));
  for (long k = 0; k < steps; ++k) {
    const double t = (static_cast<double>(k) + 0.5) * h / Excitation::kPeriod_s;
    const double sign = t < 0.5 ? 1.0 : t < 1.0 ? -1.0 : 0.0;
    simulator.Step(x, sign * torque, h);
    run.sample.push_back(SampleOf(model, x, static_cast<double>(k + 1) * h));
    for (std::size_t i = 0; i < 2; ++i) {
      run.peak_bending_mm[i] =
          std::max(run.peak_bending_mm[i], std::fabs(run.sample.back().bending_mm[i]));
    }
  }
  run.tip_m = model.TipPosition(x.q);
  return run;
}

void Draw(const Run& run, const std::filesystem::path& output) {
  std::ostringstream script;
  script << TerminalFor(output, 1200, 800) << std::setprecision(8) << "$data << EOD\n";
  const std::size_t stride = std::max<std::size_t>(1, run.sample.size() / 2000);
  for (std::size_t i = 0; i < run.sample.size(); i += stride) {
    const Sample& s = run.sample[i];
    script << s.time_s << ' ' << s.bending_mm[0] << ' ' << s.bending_mm[1] << ' ' << s.joint_deg[0]
           << ' ' << s.joint_deg[1] << '\n';
  }
  script << "EOD\nset multiplot layout 2,2 title 'One period of a square wave of torque, from "
            "rest'\nset grid lc rgb '#D9D9D9'\nunset key\nset xlabel 's'\n";
  int column = 2;
  for (const char* label :
       {"bending of link 1, mm", "bending of link 2, mm", "joint 1, deg", "joint 2, deg"}) {
    script << "set ylabel " << Quoted(label) << "\nplot $data using 1:" << column
           << " with lines lw 2 lc rgb '" << Colour(0) << "'\n";
    ++column;
  }
  script << "unset multiplot\n";
  RunGnuplot(script.str());
}

nlohmann::ordered_json ToJson(const Options& options, const Run& run) {
  return {{"torque_nm", options.excitation.torque_nm},
          {"duration_s", options.duration_s},
          {"modes", options.modes},
          {"peak_bending_mm", run.peak_bending_mm},
          {"final_joint_deg", run.sample.back().joint_deg},
          {"final_tip_m", std::array{run.tip_m.x(), run.tip_m.y()}}};
}

void Excite(const Options& options) {
  if (!options.output.empty()) CheckPicture(options.output);
  const Run run = RunOf(options);
  if (!options.output.empty()) {
    Draw(run, options.output);
    std::cerr << "wrote " << options.output.string() << '\n';
  }
  const nlohmann::ordered_json json = ToJson(options, run);
  if (options.json) {
    std::cout << json.dump(2) << '\n';
    return;
  }
  std::cout << std::setprecision(6) << "largest bending, mm: " << run.peak_bending_mm[0] << ' '
            << run.peak_bending_mm[1] << "\ntip after " << options.duration_s
            << " s, m: " << run.tip_m.x() << ' ' << run.tip_m.y() << '\n';
}

}  // namespace

void RegisterAnalyzeExcite(CLI::App& analyze, Exit&) {
  const auto options = std::make_shared<Options>();
  CLI::App* verb =
      analyze.add_subcommand("excite", "The arm under one period of a square wave (chapter 4)");
  options->config.AddTo(verb, true);
  verb->add_option("--modes", options->modes, "Bending modes a link")
      ->check(CLI::Range(1, kMaxSteppedModes))
      ->capture_default_str();
  verb->add_option("--theta2-deg", options->theta2_deg, "Elbow angle at the start")
      ->check(NumberWithin(-180.0, 180.0))
      ->capture_default_str();
  verb->add_option("--torque-nm", options->excitation.torque_nm, "Amplitudes of the motor torques")
      ->check(NumberWithin(-1e4, 1e4))
      ->type_name("TAU1 TAU2")
      ->capture_default_str();
  verb->add_option("--duration-s", options->duration_s, "Length of the run")
      ->check(NumberWithin(0.01, 600.0))
      ->capture_default_str();
  verb->add_flag("--without-dissipation", options->without_dissipation,
                 "Leave out dry friction and the links' damping");
  AddJson(verb, &options->json);
  verb->add_option("-o,--output", options->output,
                   "Picture of bending and joint angles, .png or .svg (figures 4.4 and 4.5)")
      ->type_name("FILE");
  verb->footer(
      "The wave has a period of 1 s; the thesis does not state its amplitude.\n"
      "Example: flexarm analyze excite -c config/thesis-rig.toml -o square-wave.png");
  verb->callback([options] { Excite(*options); });
}

}  // namespace flexarm
