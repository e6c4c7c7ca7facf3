#pragma once

#include <string>
#include <string_view>

#include "tools/dashboard/experiment_list.h"

namespace flexarm {

/// A command as the daemon gets it.
struct DaemonCommand {
  std::string name;        ///< "stop"
  std::string line;        ///< one line of docs/protocol.md, without its newline
  double within_s = 10.0;  ///< the longest that the daemon may take

  /// It waits behind no other command.
  bool is_urgent() const { return name == "stop" || name == "disarm"; }
};

/// The command that a browser asks for, from a JSON object with the key "command" and those of
/// docs/dashboard.md. Only what is known is passed on, and nothing else of the text.
/// @throws InputError, ConfigError saying what is wrong. Pure but for the file of an experiment.
DaemonCommand ReadCommand(std::string_view text, const ExperimentList& experiments);

}  // namespace flexarm
