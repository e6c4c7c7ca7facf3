#include <CLI/CLI.hpp>
#include <functional>
#include <iostream>
#include <map>
#include <memory>
#include <sstream>

#include "controller/commissioning/calibration_file.h"
#include "controller/files/external_text.h"
#include "controller/files/input_error.h"
#include "controller/files/write_file.h"
#include "controller/runlog/csv.h"
#include "controller/runlog/decoded_csv.h"
#include "tools/command_line/config_refusal.h"
#include "tools/command_line/options.h"
#include "tools/command_line/other_programs.h"
#include "tools/command_line/run_choice.h"
#include "tools/command_line/verbs.h"
#include "tools/mat/decoded_mat.h"
#include "tools/runs/run_summary.h"

namespace flexarm {
namespace {

struct ExportOptions {
  RunChoice choice;
  std::filesystem::path run;  // the chosen one
  OutputOptions output;
  bool decoded = false;
  bool with_raw = false;
};

void ReportSamples(std::int64_t rows, const std::filesystem::path& output) {
  std::cerr << "wrote " << rows << " samples to " << Shown(output.string(), kMessageBytes) << '\n';
}

void ExportRaw(const ExportOptions& options) {
  RunReader reader(options.run);
  const RigConfig config = ConfigOf(reader);
  const std::filesystem::path& output = options.output.file;
  std::ostringstream csv;
  CsvWriter writer(&csv, config.sensors, reader.info().start_ns);
  const OutputRules rules = options.output.Rules("samples", csv.str().c_str(), {options.run});
  CheckOutput(output, rules);
  std::int64_t rows = 0;
  Calibration calibration{};
  reader.ForEachTick([&](const TickRecord& record) {
    writer.Row(record.input);
    calibration = record.input.calibration;
    ++rows;
  });
  WriteFile(output, csv.str(), rules);
  ReportSamples(rows, output);
  if (calibration == Calibration{}) return;
  std::filesystem::path beside = output;
  beside.replace_extension(".calibration.json");
  WriteFile(beside, CalibrationText(config.sensors, calibration),
            options.output.Rules("a calibration", kCalibrationMark, {options.run}));
  std::cerr
      << "the exported counts are raw and the rig was calibrated: replay them with --calibration "
      << beside.string() << '\n';
}

bool IsMat(const std::filesystem::path& file) { return file.extension() == ".mat"; }

// Gives every sample of the run to `row`. @returns how many there are
std::int64_t ForEachDecoded(RunReader& reader, const std::map<std::int64_t, TimingRecord>& timing,
                            const std::function<void(const DecodedSample&)>& row) {
  std::int64_t rows = 0;
  reader.ForEachTick([&](const TickRecord& record) {
    const auto found = timing.find(record.input.tick);
    row({record, found == timing.end() ? nullptr : &found->second});
    ++rows;
  });
  return rows;
}

void ExportDecoded(const ExportOptions& options) {
  RunReader reader(options.run);
  const RigConfig config = ConfigOf(reader);
  const bool mat = IsMat(options.output.file);
  const OutputRules rules =
      options.output.Rules("decoded samples", mat ? kDecodedMatMark : kDecodedMark, {options.run});
  CheckOutput(options.output.file, rules);
  std::map<std::int64_t, TimingRecord> timing;
  reader.ForEachTiming([&](const TimingRecord& record) { timing[record.tick] = record; });
  const DecodedRun run{.sensors = config.sensors,
                       .tip = TipGeometryOf(config),
                       .start_ns = reader.info().start_ns,
                       .simulated = reader.info().backend == "sim",
                       .timed = !timing.empty(),
                       .with_raw = options.with_raw};
  std::int64_t rows = 0;
  if (mat) {
    DecodedMat file(run);
    rows = ForEachDecoded(reader, timing, [&](const DecodedSample& sample) { file.Row(sample); });
    WriteFile(options.output.file, file.Bytes(), rules);
  } else {
    std::ostringstream csv;
    DecodedCsvWriter file(&csv, run);
    rows = ForEachDecoded(reader, timing, [&](const DecodedSample& sample) { file.Row(sample); });
    WriteFile(options.output.file, csv.view(), rules);
  }
  ReportSamples(rows, options.output.file);
}

}  // namespace

void RegisterExport(CLI::App& app, Exit&) {
  const auto options = std::make_shared<ExportOptions>();
  CLI::App* verb = AddOtherVerb(app, "export");
  options->choice.AddTo(verb);
  RefuseConfig(verb, kLogHasItsConfig);
  options->output.AddTo(verb, "CSV file to write; with --decoded also NAME.mat", true);
  CLI::Option* decoded = verb->add_flag("--decoded", options->decoded,
                                        "Values with units, for plots, in place of raw counts");
  verb->add_flag("--with-raw", options->with_raw, "Also the counts that they were decoded from")
      ->needs(decoded);
  verb->footer(
      "Columns: time_s, counter_1..4 and strain_<link>_<number> as raw counts, valid (1, 0 or a\n"
      "mask), torque_1_nm and torque_2_nm as applied. A calibration of the run is\n"
      "written beside the CSV file, as NAME.calibration.json.\n"
      "With --decoded: a row of names, a row of units, then angles, references, strains, modal\n"
      "coordinates, torques, estimate, tip, state, payload and timing; docs/run-logs.md lists\n"
      "them. `flexarm replay` does not read that file. A file that is called NAME.mat gets the\n"
      "same columns as variables for MATLAB, Octave and SciPy, and their units in `units`.\n"
      "Examples: flexarm export runs/today.flexarm -o today.csv\n"
      "          flexarm export runs/today.flexarm --decoded -o values.csv\n"
      "          flexarm export runs/today.flexarm --decoded -o values.mat");
  verb->callback([options] {
    options->run = options->choice.File();
    if (options->decoded) {
      ExportDecoded(*options);
    } else if (IsMat(options->output.file)) {
      throw InputError(Shown(options->output.file.string(), kMessageBytes) +
                       ": a MAT file has decoded columns only: add --decoded, or name a .csv file");
    } else {
      ExportRaw(*options);
    }
  });
}

}  // namespace flexarm
