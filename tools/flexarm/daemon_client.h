#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "tools/command_line/options.h"

namespace flexarm {

/// What every verb that talks to the running daemon takes.
struct DaemonClient {
  ConfigOptions config;
  std::string socket;
  bool json = false;

  /// A verb with --socket, -c and --json bound to this, which must outlive it.
  CLI::App* AddVerb(CLI::App& app, const char* name, const char* what);

  /// Sends `command` and waits for the answer. @throws Refused, InputError
  nlohmann::ordered_json Ask(const nlohmann::ordered_json& command, double within_s = 5.0) const;

  /// The answer as JSON if that was asked for; why it was refused, on stderr. @returns exit code
  int Conclude(const nlohmann::ordered_json& answer) const;
};

}  // namespace flexarm
