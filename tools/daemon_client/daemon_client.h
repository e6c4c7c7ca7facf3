#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace flexarm {

/// Options of every verb that talks to the running daemon, and the exchange with the daemon.
struct DaemonClient {
  std::filesystem::path config;  ///< empty, or that of the daemon, for its socket
  std::string socket;
  bool json = false;
  bool take_over = false;

  /// Adds a verb whose --socket, -c and --json are bound to this object, which must outlive the
  /// verb.
  CLI::App* AddVerb(CLI::App& app, const char* name, const char* what);

  /// Adds --take-over to a verb that needs the lease.
  void AddTakeOver(CLI::App* verb);

  /// Path of the daemon's socket. @throws ConfigError
  std::string SocketPath() const;

  /// Sends `command` and waits for the answer, which is a JSON object. @throws RejectedError,
  /// InputError
  nlohmann::ordered_json Ask(nlohmann::ordered_json command, double within_s = 5.0) const;

  /// Prints the answer as JSON if --json was given, and the reason of a refusal to stderr. @returns
  /// exit code
  int Conclude(const nlohmann::ordered_json& answer) const;
};

}  // namespace flexarm
