#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "controller/files/external_json.h"
#include "controller/files/external_text.h"
#include "controller/files/write_file.h"
#include "controller/runlog/errors.h"
#include "tools/command_line/options.h"
#include "tools/command_line/other_programs.h"
#include "tools/command_line/verbs.h"
#include "tools/identification/changed_lines.h"
#include "tools/identification/comparison_picture.h"
#include "tools/identification/identification.h"
#include "tools/runs/run_summary.h"
#include "tools/support/parallel_for.h"

namespace flexarm {
namespace {

constexpr const char* kConfigName = "identified.toml";
constexpr const char* kResultName = "identification.json";
constexpr const char* kPictureName = "identification.png";

struct IdentifyOptions {
  ConfigOptions config;
  std::filesystem::path run, validate;
  OutputOptions output;
  std::vector<std::string> free;
  std::vector<double> span, validate_span;
  bool json = false;
};

// One run with its fit before and after the identification.
struct Judged {
  RunComparison run;
  Eigen::MatrixXd predicted;
  Eigen::VectorXd start_fit, fit;
};

Judged Judge(RunComparison run, const RigConfig& start, const RigConfig& found) {
  const Eigen::VectorXd start_fit = FitPercent(run, run.Predict(start));
  Eigen::MatrixXd predicted = run.Predict(found);
  const Eigen::VectorXd fit = FitPercent(run, predicted);
  return {std::move(run), std::move(predicted), start_fit, fit};
}

TimeSpan SpanOf(const std::vector<double>& given) {
  if (given.empty()) return {};
  if (!(given[0] < given[1])) throw InputError("identify: expected a span FROM < TO, in seconds");
  return {.from_s = given[0], .until_s = given[1]};
}

RigConfig ConfigFor(const IdentifyOptions& options) {
  if (options.config.given()) return options.config.Load();
  if (options.run.extension() == ".csv") {
    throw InputError(options.run.string() +
                     ": a CSV file needs the config of its rig: add -c FILE");
  }
  const RigConfig config = ConfigOf(RunReader(options.run));
  return WithOverrides(config, options.config.overrides);
}

nlohmann::ordered_json ToJson(const Judged& judged) {
  nlohmann::ordered_json json{{"file", judged.run.file().string()},
                              {"samples", judged.run.measured().rows()}};
  for (std::size_t i = 0; i < judged.run.signal().size(); ++i) {
    const auto signal = static_cast<Eigen::Index>(i);
    json["fit"].push_back({{"signal", judged.run.signal()[i].name},
                           {"start_percent", NumberOrNull(judged.start_fit(signal))},
                           {"found_percent", NumberOrNull(judged.fit(signal))}});
  }
  return json;
}

nlohmann::ordered_json ToJson(const Identification& result, const std::vector<Judged>& judged) {
  nlohmann::ordered_json json{{"converged", result.converged},
                              {"predictions", result.predictions},
                              {"start_misfit", result.start_misfit},
                              {"misfit", result.misfit}};
  for (const FoundParameter& p : result.parameter) {
    json["parameters"].push_back({{"key", p.free.key},
                                  {"start", p.free.start},
                                  {"found", p.found},
                                  {"standard_error", NumberOrNull(p.standard_error)},
                                  {"at_bound", p.at_bound}});
  }
  json["identification"] = ToJson(judged.front());
  json["validation"] = judged.size() > 1 ? ToJson(judged.back()) : nullptr;
  return json;
}

void PrintIdentification(const nlohmann::ordered_json& json) {
  std::printf("%-44s %12s %12s %12s\n", "parameter", "start", "found", "std. error");
  for (const auto& p : json["parameters"]) {
    const auto& error = p["standard_error"];
    std::printf("%-44s %12.5g %12.5g ", p["key"].get<std::string>().c_str(),
                p["start"].get<double>(), p["found"].get<double>());
    if (error.is_null()) {
      std::printf("%12s", "unknown");
    } else {
      std::printf("%12.2g", error.get<double>());
    }
    std::printf("%s\n", p["at_bound"].get<bool>() ? "  at its bound" : "");
  }
  for (const char* part : {"identification", "validation"}) {
    if (json[part].is_null()) continue;
    std::printf("\n%s on %s, %d samples\n%-44s %12s %12s\n", part,
                json[part]["file"].get<std::string>().c_str(), json[part]["samples"].get<int>(),
                "signal", "start fit, %", "found fit, %");
    for (const auto& fit : json[part]["fit"]) {
      std::printf("%-44s %12.2f %12.2f\n", fit["signal"].get<std::string>().c_str(),
                  fit["start_percent"].get<double>(), fit["found_percent"].get<double>());
    }
  }
  std::printf("\n%d predictions%s\n", json["predictions"].get<int>(),
              json["converged"].get<bool>() ? "" : ", the limit: not converged");
}

// The folder was judged as a whole: only its inputs are kept.
OutputRules RulesOf(const IdentifyOptions& options) {
  return {.kind = "a result",
          .mark = {},
          .inputs = {options.config.file, options.run, options.validate},
          .overwrite = true};
}

void PrepareFolder(const IdentifyOptions& options) {
  MakeOutputFolder(options.output.file, options.output.overwrite);
  for (const char* name : {kConfigName, kResultName, kPictureName}) {
    CheckOutput(options.output.file / name, RulesOf(options));
  }
}

void Write(const IdentifyOptions& options, const Identification& result,
           const std::vector<Judged>& judged, const nlohmann::ordered_json& json) {
  const auto write = [&](const char* name, const std::string& text) {
    const std::filesystem::path file = options.output.file / name;
    WriteFile(file, text, RulesOf(options));
    ReportWritten(file);
  };
  write(kConfigName, result.config.text);
  write(kResultName, json.dump(2) + "\n");
  std::vector<ComparisonColumn> columns;
  for (const Judged& j : judged) {
    const std::string part = columns.empty() ? "identification" : "validation";
    columns.push_back({part + " on " + j.run.file().filename().string(), &j.run, j.predicted});
  }
  const std::filesystem::path picture = options.output.file / kPictureName;
  DrawComparison(columns, picture, RulesOf(options));
  ReportWritten(picture);
}

int Run(const IdentifyOptions& options) {
  const RigConfig config = ConfigFor(options);
  if (options.output.given()) PrepareFolder(options);
  std::vector<FreeParameter> free;
  for (const std::string& text : options.free) free.push_back(ParseFreeParameter(config, text));
  RunComparison run(options.run, config, SpanOf(options.span));
  std::optional<RunComparison> other;
  if (!options.validate.empty())
    other.emplace(options.validate, config, SpanOf(options.validate_span));
  const Identification result =
      Identify(config, run, free, ProgressBar("predictions", MostPredictions(free.size())));
  std::vector<Judged> judged;
  judged.push_back(Judge(std::move(run), config, result.config));
  if (other) judged.push_back(Judge(std::move(*other), config, result.config));
  const std::vector<ChangedLine> lines =
      ChangedLines(config, result, options.config.file, options.config.overrides);
  nlohmann::ordered_json json = ToJson(result, judged);
  json["changed"] = LinesJson(lines);
  if (options.output.given()) Write(options, result, judged, json);
  if (options.json) {
    std::cout << PrintedJson(json) << '\n';
  } else {
    PrintIdentification(json);
    std::cout << "\nlines to change:\n" << ShownMessage(LinesText(lines));
  }
  return result.converged ? Exit::kDone : Exit::kFailed;
}

}  // namespace

void RegisterIdentify(CLI::App& app, Exit& exit) {
  const auto options = std::make_shared<IdentifyOptions>();
  CLI::App* verb = AddOtherVerb(app, "identify");
  options->config.AddTo(verb, false);
  verb->add_option("--run", options->run, "Run log or CSV file (*.csv) to identify from")
      ->required()
      ->type_name("RUN_OR_CSV");
  verb->add_option("--free", options->free,
                   "Parameter to identify, a config key as in --set; searched from a tenth to ten "
                   "times its value, or between LOW and HIGH; repeatable")
      ->required()
      ->type_name("KEY[=LOW:HIGH]")
      ->allow_extra_args(false);
  verb->add_option("--validate", options->validate, "Another run to validate the result with")
      ->type_name("RUN_OR_CSV");
  verb->add_option("--span", options->span,
                   "Use this part of --run only, in seconds; the arm should be at rest at FROM")
      ->expected(2)
      ->type_name("FROM TO");
  verb->add_option("--validate-span", options->validate_span, "The same for --validate")
      ->expected(2)
      ->type_name("FROM TO");
  AddJson(verb, &options->json);
  options->output.AddTo(verb, "Folder for identified.toml, identification.json and .png", false,
                        "DIR");
  verb->footer(
      "The nonlinear model gets the torques of the run and the joint angles at its start.\n"
      "fit = 100 (1 - |y - yhat| / |y - mean y|) over the whole run, for the joint angles and for\n"
      "the tip deflections measured by the gauges. The standard errors do not include effects\n"
      "that the model lacks. At the end stand the lines of the config to change, with file, line\n"
      "and old value: the identified ones, and those that `flexarm config new` derived from them.\n"
      "Exit code 1: the search did not converge. More in docs/identification.md.\n"
      "Example: flexarm identify --run a.flexarm --validate b.flexarm -o found\n"
      "             --free joint1.coulomb_friction_nm --free link1.damping_ratio=0:0.2");
  verb->callback([options, &exit] { exit.code = Run(*options); });
}

}  // namespace flexarm
