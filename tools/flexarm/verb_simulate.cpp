#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cstdio>
#include <iostream>
#include <memory>
#include <optional>

#include "controller/design/design_verdict.h"
#include "controller/design/run_design.h"
#include "controller/files/external_json.h"
#include "controller/files/external_text.h"
#include "controller/host/run_judge.h"
#include "controller/host/simulation.h"
#include "controller/runlog/errors.h"
#include "controller/types/law_table.h"
#include "controller/types/rejected_error.h"
#include "tools/command_line/completion.h"
#include "tools/command_line/label_options.h"
#include "tools/command_line/options.h"
#include "tools/command_line/run_choice.h"
#include "tools/command_line/verbs.h"
#include "tools/flexarm/like_run.h"
#include "tools/flexarm/run_pictures.h"
#include "tools/runs/run_summary.h"
#include "tools/support/scratch_folder.h"

namespace flexarm {
namespace {

struct SimulateOptions {
  ConfigOptions config;
  RunChoice like;
  std::filesystem::path plot;
  std::filesystem::path experiment;
  std::string controller, estimator;
  std::optional<double> payload_kg;
  double speed_percent = 100.0;
  std::optional<int> plant_modes;
  std::optional<std::uint64_t> seed;
  bool without_prediction = false;
  bool without_adaptation = false;
  bool ideal = false;
  bool unchecked = false;
  std::filesystem::path output;
  LabelOptions label;
  bool json = false;
};

// --set, and the short options, which set config keys, so that the config in the log describes the
// run completely.
std::vector<std::string> OverridesOf(const SimulateOptions& options) {
  std::vector<std::string> overrides = options.config.overrides;
  const auto set = [&overrides](const char* key, const std::string& value) {
    overrides.push_back(std::string(key) + "=" + value);
  };
  if (!options.controller.empty()) set("controller.name", options.controller);
  if (options.ideal) set("estimator.name", "ideal");
  if (!options.estimator.empty()) set("estimator.name", options.estimator);
  if (options.plant_modes) set("sim.plant_modes", std::to_string(*options.plant_modes));
  if (options.seed) set("sim.seed", std::to_string(*options.seed));
  if (options.without_prediction) set("controller.prediction", "false");
  if (options.without_adaptation) set("controller.adaptation", "false");
  return overrides;
}

SimulationRequest RequestOfConfig(const SimulateOptions& options) {
  if (!options.config.given()) throw CLI::RequiredError("--config, or --like RUN");
  SimulationRequest request;
  request.config = LoadConfig(options.config.file, OverridesOf(options));
  ChosenExperiment chosen =
      ChooseExperiment(options.experiment, options.config.file, request.config);
  request.experiment_file = std::move(chosen.file);
  request.experiment = std::move(chosen.experiment);
  request.payload_kg = options.payload_kg;
  return request;
}

// The same rig, experiment, payload, place and noise as in a run, with other options.
SimulationRequest RequestLike(const SimulateOptions& options, const std::filesystem::path& file) {
  const LikeRun like = LoadLikeRun(file);
  SimulationRequest request;
  request.config = WithOverrides(like.config, OverridesOf(options));
  request.experiment_file = file;
  request.experiment = like.experiment;
  request.payload_kg = options.payload_kg ? options.payload_kg : like.payload_kg;
  request.start_rad = like.start_rad;
  request.calibration = like.calibration;
  if (request.payload_kg) return request;
  throw InputError(file.string() + ": the run of a rig, whose payload is not known" +
                   (like.payload_estimate.empty()
                        ? ""
                        : " (" + like.payload_estimate + " by its own estimate)") +
                   ": give it with --payload-kg");
}

RunPictures PicturesOf(const SimulateOptions& options) {
  RunPictures pictures;
  const bool page = options.plot.extension() == ".html";
  (page ? pictures.page : pictures.picture.file) = options.plot;
  return pictures;
}

void ShowProgress(double simulated_s) {
  std::fprintf(stderr, "\rsimulated %.1f s", simulated_s);
  std::fflush(stderr);
}

nlohmann::ordered_json ToJson(const DesignVerdict& design) {
  return {{"verdict", ToString(design.result)}, {"found", design.found}};
}

nlohmann::ordered_json ToJson(const SimulationResult& result, const DesignVerdict& design,
                              const std::filesystem::path& run) {
  nlohmann::ordered_json json;
  json["completed"] = result.completed;
  json["trip"] = result.trip == TripCause::kNone ? nlohmann::ordered_json(nullptr)
                                                 : nlohmann::ordered_json(ToString(result.trip));
  json["ticks"] = result.ticks;
  json.update(ToJson(result.metrics));
  json["move_duration_s"] = result.move_duration_s;
  json["delay_found"] = result.delay_found;
  json["realtime_factor"] = NumberOrNull(result.realtime_factor);
  json["design"] = ToJson(design);
  json["run"] =
      run.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(run.string());
  return json;
}

void PrintText(const SimulationResult& result, const std::filesystem::path& run) {
  const RunMetrics& m = result.metrics;
  std::printf("completed                 %s\n", result.completed ? "yes" : "NO");
  if (result.trip != TripCause::kNone) {
    std::printf("trip                      %s: %s\n", ToString(result.trip),
                OperatorText(result.trip));
  }
  std::printf("ticks                     %lld\n", static_cast<long long>(result.ticks));
  std::printf("joint rms error           %.2f, %.2f deg\n", m.joint_rms_error_deg[0],
              m.joint_rms_error_deg[1]);
  std::printf("joint largest error       %.2f, %.2f deg\n", m.joint_peak_error_deg[0],
              m.joint_peak_error_deg[1]);
  std::printf("joint final error         %.2f, %.2f deg\n", m.joint_final_error_deg[0],
              m.joint_final_error_deg[1]);
  std::printf("tip settling time         %s\n", SettlingText(m).c_str());
  std::printf("tip off its target        %.1f mm\n", m.tip_target_error_mm);
  std::printf("tip residual rms          %.1f mm\n", m.tip_residual_rms_mm);
  std::printf("peak torque               %.2f, %.2f N m\n", m.peak_torque_nm[0],
              m.peak_torque_nm[1]);
  std::printf("peak bending              %.0f, %.0f mm\n", m.peak_bending_mm[0],
              m.peak_bending_mm[1]);
  std::printf("torque rms                %.2f, %.2f N m\n", m.torque_rms_nm[0], m.torque_rms_nm[1]);
  for (std::size_t i = 0; i < result.move_duration_s.size(); ++i) {
    std::printf("move[%zu] takes             %.2f s\n", i, result.move_duration_s[i]);
  }
  if (result.delay_found != 0) {
    std::printf("delay found               %+d samples more than declared\n", result.delay_found);
  }
  std::printf("real-time factor          %.0f\n", result.realtime_factor);
  if (run.empty()) return;
  std::printf("run                       %s\n", Shown(run.string(), kMessageBytes).c_str());
}

void WarnOfDesign(const DesignVerdict& design) {
  if (design.result == DesignVerdict::Result::kSound) return;
  const bool forced = design.result == DesignVerdict::Result::kForced;
  std::cerr << "flexarm: warning: "
            << (forced ? "the gains failed checks, which --force waived: "
                       : "the daemon does not arm this design, it was rejected: ")
            << ShownMessage(design.found) << '\n';
}

// The experiment's own conditions (docs/experiments.md), as the daemon judges them.
void CheckConditions(const SimulationRequest& request) {
  const double payload_kg = request.payload_kg.value_or(request.config.arm.payload_mass_kg);
  std::optional<UnmetCondition> unmet =
      PayloadObjection(request.experiment, request.config, payload_kg);
  try {
    RunJudge judge(request.config, WithLaw);
    if (!unmet) unmet = judge.Judge(request.experiment, request.start_rad);
  } catch (const RejectedError& error) {
    throw RejectedError(request.experiment_file.string() + ": " + error.what());
  }
  if (!unmet) return;
  throw RejectedError(request.experiment_file.string() + ": " + unmet->found + "; " +
                      unmet->remedy + "; --unchecked simulates it nevertheless");
}

int Run(const SimulateOptions& options) {
  const std::filesystem::path like = options.like.given() ? options.like.File() : "";
  SimulationRequest request = like.empty() ? RequestOfConfig(options) : RequestLike(options, like);
  request.experiment = AtSpeed(std::move(request.experiment), options.speed_percent / 100.0);
  std::optional<ScratchFolder> scratch;  // for the log of a picture
  if (!options.output.empty()) request.log = options.output;
  if (!options.plot.empty()) {
    if (!request.log) {
      // The file's name names the run in the picture.
      request.log = scratch.emplace().path() /
                    (std::string(LawOf(request.config.controller.kind).name) + ".flexarm");
    }
    PicturesOf(options).Check({*request.log, like});
  }
  request.label = options.label.Label();
  if (!options.unchecked) CheckConditions(request);
  const DesignVerdict design = JudgeDesign(request.config, DesignFor(request.config));
  WarnOfDesign(design);
  const bool show = isatty(STDERR_FILENO) == 1 && !options.json;
  const SimulationResult result =
      Simulate(request, show ? std::function<void(double)>(ShowProgress) : nullptr);
  if (show) std::fprintf(stderr, "\r\033[K");
  if (options.json) {
    std::cout << PrintedJson(ToJson(result, design, options.output)) << '\n';
  } else {
    PrintText(result, options.output);
  }
  if (!options.plot.empty()) {
    std::vector<std::filesystem::path> runs = {*request.log};
    if (!like.empty()) runs.insert(runs.begin(), like);
    PicturesOf(options).Draw(runs);
  }
  return result.completed ? Exit::kDone : Exit::kFailed;
}

std::string LawHelp() {
  std::string text;
  for (const LawRow& law : kLaws) {
    text += std::string(law.name) + ": " + law.about + (&law == &kLaws.back() ? "" : "\n");
  }
  return text;
}

}  // namespace

void RegisterSimulate(CLI::App& app, Exit& exit) {
  const auto options = std::make_shared<SimulateOptions>();
  CLI::App* verb = app.add_subcommand(
      "simulate", "Simulate an experiment: every task of the controller and the arm, in lock step");
  options->config.AddTo(verb, false);
  options->like.AddOptionTo(verb, "--like",
                            "Repeat this run: its config, experiment, payload, seed and place, "
                            "with the other options here");
  verb->add_option(
          "--experiment", options->experiment,
          "Experiment, a TOML file (default: experiments/square-30deg.toml beside the config or\n"
          "shipped, moves.toml for a law that follows moves only; slower or smaller if the rig "
          "needs it)")
      ->type_name("FILE");
  OfferWords(verb->add_option("--controller", options->controller,
                              "controller.name, the control law:\n" + LawHelp()),
             [] { return LawNames([](const LawRow&) { return true; }); });
  verb->add_option("--estimator", options->estimator,
                   "estimator.name: kalman, difference, polynomial, ekf-payload");
  verb->add_option("--payload-kg", options->payload_kg,
                   "Payload of the plant, kg; the controller is designed for the config's")
      ->check(NumberWithin(0.0, 100.0));
  verb->add_option("--speed", options->speed_percent,
                   "Share of the planned speed in percent, 10 to 100, as of `flexarm run`")
      ->check(NumberWithin(100.0 * kLeastSpeed, 100.0))
      ->type_name("PERCENT");
  verb->add_option("--plant-modes", options->plant_modes, "sim.plant_modes: bending modes a link");
  verb->add_option("--seed", options->seed, "sim.seed: seed of the measurement noise");
  verb->add_flag("--without-prediction", options->without_prediction,
                 "controller.prediction = false: the delay is not compensated");
  verb->add_flag(
      "--without-adaptation", options->without_adaptation,
      "controller.adaptation = false: the same feedforward and feedback with fixed gains");
  verb->add_flag("--ideal", options->ideal,
                 "estimator.name = ideal: the state is known and the torque acts at once, without\n"
                 "sensors, delay, torque gate and safety tasks, as in the thesis's simulations")
      ->excludes("--estimator");
  verb->add_flag("--unchecked", options->unchecked,
                 "Simulate also what the experiment's laws and payload_kg refuse: another law,\n"
                 "another payload, a run that is predicted to trip");
  verb->add_option("-o,--output", options->output, "Run log to write (must not exist)")
      ->type_name("RUN");
  verb->add_option("--plot", options->plot,
                   "Picture of the run to write, .png or .svg, or page, .html; with --like also of "
                   "the run that it repeats")
      ->type_name("FILE");
  for (const char* like : {"--like", "--last"}) {
    verb->get_option(like)->excludes("--config")->excludes("--experiment");
  }
  options->label.AddTo(verb);
  AddJson(verb, &options->json);
  verb->footer(
      "Prints tracking errors, settling time of the tip and peak torques, and warns of a design\n"
      "that `flexarm design` rejects and the daemon does not arm; `flexarm plot` draws\n"
      "the run log. The same config and seed give the same run, tick for tick. An experiment that\n"
      "states laws or payload_kg refuses what it is not for, and names a law that works\n"
      "(docs/experiments.md). Exit code 1 if the run tripped.\n"
      "Examples: flexarm simulate -c config/hil.toml\n"
      "          flexarm simulate -c config/hil.toml --payload-kg 0.2 -o heavy.flexarm --tag "
      "heavy\n"
      "          flexarm simulate -c config/hil.toml --ideal --payload-kg 0.01\n"
      "          flexarm simulate -c config/hil.toml --set controller.alpha=2 --json\n"
      "          flexarm simulate --like runs/today.flexarm --controller gain-scheduled --plot "
      "laws.png\n"
      "          flexarm simulate --last --controller pd -o pd.flexarm");
  verb->callback([options, &exit] { exit.code = Run(*options); });
}

}  // namespace flexarm
