#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <sstream>

#include "controller/commissioning/calibration_file.h"
#include "controller/files/external_text.h"
#include "controller/files/write_file.h"
#include "controller/runlog/csv.h"
#include "tools/command_line/options.h"
#include "tools/command_line/verbs.h"
#include "tools/runs/run_summary.h"

namespace flexarm {
namespace {

struct ExportOptions {
  std::filesystem::path run;
  OutputOptions output;
};

void Export(const ExportOptions& options) {
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
  std::cerr << "wrote " << rows << " samples to " << Shown(output.string(), kMessageBytes) << '\n';
  if (calibration == Calibration{}) return;
  std::filesystem::path beside = output;
  beside.replace_extension(".calibration.json");
  WriteFile(beside, CalibrationText(config.sensors, calibration),
            options.output.Rules("a calibration", kCalibrationMark, {options.run}));
  std::cerr
      << "the exported counts are raw and the rig was calibrated: replay them with --calibration "
      << beside.string() << '\n';
}

}  // namespace

void RegisterExport(CLI::App& app, Exit&) {
  const auto options = std::make_shared<ExportOptions>();
  CLI::App* verb = app.add_subcommand(
      "export", "Export the samples of a run log as a CSV file that `flexarm replay` reads");
  verb->add_option("run", options->run, "Run log")->required()->type_name("RUN");
  options->output.AddTo(verb, "CSV file to write", true);
  verb->footer(
      "Columns: time_s, counter_1..4 and strain_<link>_<number> as raw counts, valid (1, 0 or a\n"
      "mask), torque_1_nm and torque_2_nm as applied. A calibration of the run is\n"
      "written beside the CSV file, as NAME.calibration.json.\n"
      "Example: flexarm export runs/today.flexarm -o today.csv");
  verb->callback([options] { Export(*options); });
}

}  // namespace flexarm
