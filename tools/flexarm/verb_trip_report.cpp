#include <CLI/CLI.hpp>
#include <memory>

#include "controller/files/write_file.h"
#include "controller/runlog/trip_reports.h"
#include "tools/command_line/config_refusal.h"
#include "tools/command_line/options.h"
#include "tools/command_line/run_choice.h"
#include "tools/command_line/verbs.h"
#include "tools/trip_report/trip_page.h"

namespace flexarm {
namespace {

struct TripReportOptions {
  RunChoice run;
  OutputOptions output;
  std::size_t trip = 1;
};

void Write(const TripReportOptions& options) {
  const std::filesystem::path log = options.run.File();
  const std::filesystem::path file =
      options.output.given() ? options.output.file : NewTripPage(log);
  const OutputRules rules = options.output.Rules("a trip report", kTripPageMark, {log});
  CheckOutput(file, rules);
  WriteFile(file, TripPage(log, options.trip - 1), rules);
  ReportWritten(file);
}

}  // namespace

void RegisterTripReport(CLI::App& app, Exit&) {
  const auto options = std::make_shared<TripReportOptions>();
  CLI::App* verb = app.add_subcommand(
      "trip-report", "Write the report of a trip: causes, signals, what to check, one HTML page");
  options->run.AddTo(verb);
  RefuseConfig(verb, kLogHasItsConfig);
  options->output.AddTo(verb, "Page to write; without it RUN.trip.html beside the log", false);
  verb->add_option("--trip", options->trip, "Which trip of the log, from 1 on")
      ->type_name("N")
      ->check(NumberWithin(1, 1e6))
      ->capture_default_str();
  verb->footer(
      "flexarmd writes this page by itself for every trip, and `flexarm status` names it. This "
      "verb\n"
      "makes it from the log, also of a daemon that was killed.\n"
      "The page needs no other file and no network.\n"
      "Examples: flexarm trip-report runs/today.flexarm\n"
      "          flexarm trip-report --last -o trip.html");
  verb->callback([options] { Write(*options); });
}

}  // namespace flexarm
