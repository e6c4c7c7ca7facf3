#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "controller/design/run_design.h"
#include "controller/files/external_json.h"
#include "controller/law/design.h"
#include "controller/runlog/build_info.h"
#include "controller/runlog/errors.h"
#include "controller/runlog/replay.h"
#include "tools/command_line/options.h"
#include "tools/command_line/run_choice.h"
#include "tools/command_line/verbs.h"
#include "tools/csv/csv_replay.h"
#include "tools/csv/csv_report.h"
#include "tools/csv/scale_warnings.h"
#include "tools/replay/log_replay.h"
#include "tools/runs/run_summary.h"

namespace flexarm {
namespace {

struct ReplayOptions {
  RunChoice choice;
  std::filesystem::path source;  // the chosen one
  ConfigOptions config;
  std::filesystem::path calibration, experiment;  // empty: none
  bool json = false;
};

// Between processors the last digits differ: Eigen fuses a product and a sum into one rounding on
// arm64. Lane arm64 finds 1e-13, and 6e-9 with the nonlinear filter `ekf-payload`. One count of an
// encoder is more than 1e-4 of an angle's largest value there.
constexpr double kEstimateTolerance = 1e-6;

struct Outcome {
  ReplayResult result;
  std::string other_build;                 // the recorded build id, if it is not this one's
  bool digest_holds = true;                // of a log
  bool has_reference = true;               // without one, torques cannot be compared
  std::int64_t after_experiment = 0;       // samples of a CSV file that were left out
  nlohmann::ordered_json csv{}, scales{};  // of a CSV file: what it holds, and of its strains

  bool other_processor() const {
    return !other_build.empty() && ProcessorOf(other_build) != ProcessorOf(BuildId());
  }
  // The bytes must be equal. Where they cannot be, the estimate must agree.
  bool failed() const {
    if (!digest_holds) return true;
    if (!result.safety_exact.value_or(true)) return true;
    if (result.bit_exact.value_or(true)) return false;
    return !other_processor() || !(result.estimate_difference.value() <= kEstimateTolerance);
  }
};

bool IsIdeal(const RigConfig& config) { return config.estimator.kind == EstimatorKind::kIdeal; }

// The config of the replay: --set without -c changes that of the log.
RigConfig OtherConfig(const ConfigOptions& options, const RigConfig& own) {
  if (options.given()) return options.Load();
  return options.overrides.empty() ? own : WithOverrides(own, options.overrides);
}

Outcome ReplayRun(const ReplayOptions& options) {
  if (!options.calibration.empty()) {
    throw InputError("--calibration is for CSV files only: a run log contains its own calibration");
  }
  if (!options.experiment.empty()) {
    throw InputError("--experiment is for CSV files only: a run log contains its own reference");
  }
  RunReader reader(options.source);
  const RigConfig own = ConfigOf(reader);
  const RigConfig config = OtherConfig(options.config, own);
  const bool other_config = config.text != own.text;
  const Design design = other_config ? DesignFor(config) : GainsOf(reader, config);
  if (IsIdeal(config) && !IsIdeal(own)) {
    throw InputError(reader.file().string() +
                     ": the true state is not in this log, which estimator.name = \"ideal\" needs");
  }
  const ReplayResult result = ReplayLog(&reader, config, design, other_config);
  const std::string& build = reader.info().build_id;
  return {.result = result,
          .other_build = build == BuildId() ? "" : build,
          .digest_holds = reader.DigestHolds()};
}

Outcome ReplayTable(const ReplayOptions& options) {
  if (!options.config.given()) {
    throw InputError(options.source.string() +
                     ": a CSV file needs the config of its rig: add -c FILE");
  }
  const RigConfig config = options.config.Load();
  const CsvReplayResult replayed = ReplayCsv({.source = options.source,
                                              .config = config,
                                              .calibration = options.calibration,
                                              .experiment = options.experiment});
  return {.result = replayed.result,
          .other_build = "",
          .has_reference = replayed.left_out.has_value(),
          .after_experiment = replayed.left_out.value_or(0),
          .csv = CsvFactsJson(replayed.facts, config),
          .scales = ScalesJson(replayed.scales,
                               ScaleWarnings(replayed.scales, config, replayed.facts), config)};
}

template <typename T>
nlohmann::ordered_json OrNull(const std::optional<T>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

nlohmann::ordered_json ToJson(const Outcome& outcome) {
  const ReplayResult& result = outcome.result;
  nlohmann::ordered_json json;
  json["ticks"] = result.ticks;
  json["ticks_before_reset"] = result.ticks_before_reset;
  json["bit_exact"] = OrNull(result.bit_exact);
  json["ticks_after_experiment"] = outcome.after_experiment;
  json["max_torque_difference_nm"] = nullptr;
  if (outcome.has_reference) {
    json["max_torque_difference_nm"] = {NumberOrNull(result.max_torque_difference_nm[0]),
                                        NumberOrNull(result.max_torque_difference_nm[1])};
  }
  json["estimate_difference"] =
      result.estimate_difference ? NumberOrNull(*result.estimate_difference) : nullptr;
  json["hub_innovation_rms_rad"] = {NumberOrNull(result.hub_innovation_rms_rad[0]),
                                    NumberOrNull(result.hub_innovation_rms_rad[1])};
  json["faulty_ticks"] = result.faulty_ticks;
  json["safety_exact"] = OrNull(result.safety_exact);
  json["first_gap_tick"] = OrNull(result.first_gap_tick);
  json["first_different_tick"] = OrNull(result.first_different_tick);
  json["safety_records"] = result.safety_records;
  json["same_build"] = outcome.other_build.empty();
  json["digest_holds"] = outcome.digest_holds;
  json["csv"] = outcome.csv;
  json["strain_scale"] = outcome.scales;
  return json;
}

const char* Word(const std::optional<bool>& exact) {
  if (!exact) return "not compared";
  return *exact ? "yes" : "NO";
}

std::string EstimateText(const Outcome& outcome) {
  const std::optional<double>& difference = outcome.result.estimate_difference;
  if (!difference) return "not compared";
  std::ostringstream text;
  text << *difference << " of a state's largest value";
  if (outcome.other_processor())
    text << " (another processor: at most " << kEstimateTolerance << ')';
  return text.str();
}

std::string TorqueText(const Outcome& outcome) {
  if (!outcome.has_reference) return "not compared: a CSV file has no reference, add --experiment";
  std::ostringstream text;
  text << outcome.result.max_torque_difference_nm[0] << ", "
       << outcome.result.max_torque_difference_nm[1] << " N m";
  return text.str();
}

void PrintText(const Outcome& outcome) {
  const ReplayResult& result = outcome.result;
  std::cout << "ticks                     " << result.ticks << '\n';
  if (result.ticks_before_reset > 0) {
    std::cout << "before the first reset    " << result.ticks_before_reset
              << ", not compared: the log of a trip outside a run begins in the middle\n";
  }
  if (outcome.after_experiment > 0) {
    std::cout << "after the experiment      " << outcome.after_experiment << ", left out\n";
  }
  std::cout << "bit exact                 " << Word(result.bit_exact) << '\n'
            << "max torque difference     " << TorqueText(outcome) << '\n'
            << "estimate difference       " << EstimateText(outcome) << '\n'
            << "hub innovations, rms      " << result.hub_innovation_rms_rad[0] << ", "
            << result.hub_innovation_rms_rad[1] << " rad\n"
            << "ticks with a fault        " << result.faulty_ticks << '\n'
            << "safety exact              " << Word(result.safety_exact) << " ("
            << result.safety_records << " records)\n";
  if (result.first_gap_tick)
    std::cout << "first missing tick        " << *result.first_gap_tick << '\n';
  if (result.bit_exact && result.first_different_tick) {
    std::cout << "first different tick      " << *result.first_different_tick << '\n';
  }
}

// What a CSV file holds, and whether its strains can be.
void PrintCsv(const Outcome& outcome) {
  for (const std::string& line : CsvFactsText(outcome.csv)) std::cout << "csv: " << line << '\n';
  std::cout << "strain scale              ";
  const char* between = "";
  for (const auto& link : outcome.scales["links"]) {
    std::cout << between << link["verdict"].get<std::string>();
    if (!link["factor"].is_null()) std::cout << ", factor " << link["factor"].get<double>();
    between = "; ";
  }
  std::cout << " (links 1, 2)\n";
}

int Run(const ReplayOptions& options) {
  const bool is_run = options.source.extension() != ".csv";
  const Outcome outcome = is_run ? ReplayRun(options) : ReplayTable(options);
  if (!outcome.other_build.empty()) {
    std::cerr << "flexarm: this run was recorded by another build: " << outcome.other_build
              << "; this build is " << BuildId() << '\n';
  }
  if (!outcome.digest_holds) {
    std::cerr << "flexarm: " << options.source.string()
              << ": digest: damaged since it was written\n";
  }
  if (options.json) {
    std::cout << PrintedJson(ToJson(outcome)) << '\n';
  } else {
    PrintText(outcome);
    if (!is_run) PrintCsv(outcome);
  }
  if (!is_run) {
    for (const auto& warning : outcome.scales["warnings"]) {
      std::cerr << "flexarm: warning: " << warning.get<std::string>() << '\n';
    }
  }
  return outcome.failed() ? Exit::kFailed : Exit::kDone;
}

}  // namespace

void RegisterReplay(CLI::App& app, Exit& exit) {
  const auto options = std::make_shared<ReplayOptions>();
  CLI::App* verb = app.add_subcommand(
      "replay", "Run recorded inputs through the control step again and compare the torques");
  options->choice.AddTo(verb, "Run log, or CSV file (*.csv)", "RUN_OR_CSV");
  options->config.AddTo(verb, false);
  verb->add_option(
          "--calibration", options->calibration,
          "Calibration of the rig that recorded the CSV file, as written by `flexarm export`")
      ->type_name("FILE");
  verb->add_option("--experiment", options->experiment,
                   "Experiment of the run in the CSV file, whose first row is the run's first")
      ->type_name("FILE");
  AddJson(verb, &options->json);
  verb->footer(
      "A run log contains its config and gains; its replay must give the same bytes, else the\n"
      "exit code is 1, as for a log that was damaged since it was written (its digest tells). A\n"
      "log of another processor (arm64, amd64) must give the same estimate to 1e-6 and the same\n"
      "safety decisions. With -c the loop uses that config instead, and the difference is\n"
      "reported; --set without -c changes values of the log's own config.\n"
      "A CSV file comes from `flexarm export`, or has the columns of the table [csv] of the\n"
      "config. It has no reference of the law: with --experiment the law follows that one and its\n"
      "torques are compared with those of the file; without, the estimator alone says something.\n"
      "The strains of a CSV file are compared with what torques and angles demand: a scale that "
      "is\n"
      "1.5 times off, or more, is a warning (strain_scale in --json).\n"
      "Examples: flexarm replay runs/today.flexarm\n"
      "          flexarm replay --last\n"
      "          flexarm replay today.csv -c config/hil.toml \\\n"
      "            --experiment config/experiments/square-30deg.toml");
  verb->callback([options, &exit] {
    options->source = options->choice.File();
    exit.code = Run(*options);
  });
}

}  // namespace flexarm
