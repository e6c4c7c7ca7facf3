#include "tools/command_line/program.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <iostream>

#include "config/config.h"
#include "controller/files/external_text.h"
#include "controller/files/failure_text.h"
#include "controller/files/input_error.h"
#include "controller/files/standard_output.h"
#include "controller/runlog/build_info.h"
#include "controller/types/rejected_error.h"
#include "tools/command_line/config_refusal.h"
#include "tools/command_line/guess.h"
#include "tools/command_line/self_description.h"
#include "tools/command_line/verbs.h"

namespace flexarm {
namespace {

void PrintError(const std::string& text) { std::cerr << "flexarm: " << ShownMessage(text) << '\n'; }

// Adds the program's name and a pointer to --help to CLI11's message.
int BadUsage(const CLI::App& app, const CLI::ParseError& error) {
  PrintError(error.what() + GuessFor(InnermostVerb(app)));
  const CLI::App* verb = &app;
  std::string name = "flexarm";
  while (!verb->get_subcommands().empty()) {
    verb = verb->get_subcommands().front();
    name += " " + verb->get_name();
  }
  std::cerr << "Try: " << name << " --help\n";
  return Exit::kBadInput;
}

int Run(const char* name, int argc, char** argv, RegisterVerbs* register_verbs) {
  Exit exit;
  CLI::App app("Controller of a two-link flexible arm: design, simulate, replay, analyse, operate.",
               "flexarm");
  app.set_version_flag("--version", "flexarm " + ThisBuild().version + " (" + BuildId() + ")");
  app.require_subcommand(1);
  app.failure_message(CLI::FailureMessage::simple);
  app.footer(
      "First steps:\n"
      "  flexarm config check config/hil.toml      validate the config of a rig\n"
      "  flexarm simulate -c config/hil.toml       simulate one run\n"
      "  flexarm info RUN.flexarm                  summarise a run\n"
      "  flexarm plot RUN.flexarm -o run.png       draw it\n"
      "  flexarm replay RUN.flexarm                recompute it and compare every byte\n"
      "Exit codes: 0 done; 1 a run, replay or check failed; 2 bad usage, config or input.");
  register_verbs(app, exit);
  RefuseConfigElsewhere(&app);
  if (const auto code = DescribeItself(app, name, 1, argc, argv)) return *code;
  const auto is_first = [&](const CLI::App* verb) { return verb->get_name() == argv[1]; };
  if (argc > 1 && argv[1][0] != '-' && app.get_subcommands(is_first).empty()) {
    PrintError("unknown verb \"" + std::string(argv[1]) + "\"" + GuessVerb(app, argv[1]) +
               "; flexarm --help lists all verbs");
    return Exit::kBadInput;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    return BadUsage(app, error);
  } catch (const ConfigError& error) {
    PrintError(error.what());
    return Exit::kBadInput;
  } catch (const RejectedError& error) {
    PrintError(error.what());
    return Exit::kBadInput;
  } catch (const InputError& error) {
    PrintError(error.what());
    return Exit::kBadInput;
  } catch (const std::exception& error) {
    PrintError(FailureText(error));
    return Exit::kFailed;
  }
  return exit.code;
}

}  // namespace

int RunProgram(const char* name, int argc, char** argv, RegisterVerbs* register_verbs) noexcept {
  try {
    const int code = Run(name, argc, argv, register_verbs);
    const std::string lost = FlushStandardOutput();
    if (lost.empty()) return code;
    PrintError(lost);
    return code == Exit::kDone ? Exit::kFailed : code;
  } catch (const std::exception& error) {
    PrintError(FailureText(error));
    return Exit::kFailed;
  } catch (...) {  // not even the message could be built
    return Exit::kFailed;
  }
}

}  // namespace flexarm
