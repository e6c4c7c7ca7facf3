#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "tools/command_line/options.h"

namespace flexarm {

/// Options of every verb that talks to the running daemon, and the exchange with the daemon.
struct DaemonClient {
  ConfigOptions config;
  std::string socket;
  bool json = false;

  /// Adds a verb whose --socket, -c and --json are bound to this object, which must outlive the
  /// verb.
  CLI::App* AddVerb(CLI::App& app, const char* name, const char* what);

  /// Sends `command` and waits for the answer. @throws RejectedError, InputError
  nlohmann::ordered_json Ask(const nlohmann::ordered_json& command, double within_s = 5.0) const;

  /// Prints the answer as JSON if --json was given, and the reason of a refusal to stderr. @returns
  /// exit code
  int Conclude(const nlohmann::ordered_json& answer) const;
};

}  // namespace flexarm
