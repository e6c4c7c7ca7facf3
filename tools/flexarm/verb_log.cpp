#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <vector>

#include "controller/runlog/run_recovery.h"
#include "tools/command_line/config_refusal.h"
#include "tools/command_line/verbs.h"

namespace flexarm {
namespace {

// Every file is tried. The worst result is the exit code.
int Recover(const std::vector<std::filesystem::path>& files) {
  int code = Exit::kDone;
  for (const std::filesystem::path& file : files) {
    const Recovery recovery = RecoverRun(file);
    const bool done = recovery.result == Recovery::Result::kRecovered ||
                      recovery.result == Recovery::Result::kClosed;
    (done ? std::cout : std::cerr << "flexarm: ") << recovery.text << '\n';
    if (!done) code = Exit::kFailed;
  }
  return code;
}

}  // namespace

void RegisterLog(CLI::App& app, Exit& exit) {
  const auto files = std::make_shared<std::vector<std::filesystem::path>>();
  CLI::App* verb = app.add_subcommand("log", "Maintain run logs");
  verb->require_subcommand(1);
  CLI::App* recover = verb->add_subcommand(
      "recover", "Turn logs that a killed program or a full disk left into closed runs");
  RefuseConfig(recover, kLogHasItsConfig);
  recover->add_option("files", *files, "Run logs")->required()->type_name("FILE");
  recover->footer(
      "While a run is recorded, its log is a record file: it only grows, and each record has a\n"
      "checksum. When the run ends, flexarm turns it into a SQLite file of the same name. A "
      "program\n"
      "that is killed leaves the record file. info, replay, plot, export, check and diff read it\n"
      "as it is; this verb makes it SQLite, for any other reader, with a result that says\n"
      "\"recovered\". flexarmd does so with the logs of its folder whenever it starts.\n"
      "A record that was only half written is left out. Of a log that is damaged in the middle,\n"
      "the part before the damage becomes the run, and all of it is kept as FILE.damaged.\n"
      "A log that a program is writing, or that is a closed run, is left alone.\n"
      "Exit code 0 all are closed runs now; 1 one is not.\n"
      "Example: flexarm log recover runs/*.flexarm");
  recover->callback([files, &exit] { exit.code = Recover(*files); });
}

}  // namespace flexarm
