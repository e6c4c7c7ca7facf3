#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace flexarm {

/// The options --override-CONDITION REASON of a verb (controller/operator/override.h).
class OverrideOptions {
 public:
  /// Adds `option`, such as "--override-host". This object must outlive the verb.
  void AddTo(CLI::App* verb, const std::string& option, const std::string& condition,
             const std::string& what);

  /// Adds the reasons that were given to a command of the daemon.
  /// @throws InputError for a reason that ProblemOfReason refuses
  void PutInto(nlohmann::ordered_json* command) const;

 private:
  struct Given {
    CLI::Option* option;
    std::string reason;
  };
  std::map<std::string, Given> given_;  // by condition
};

}  // namespace flexarm
