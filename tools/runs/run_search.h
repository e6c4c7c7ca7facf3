#pragma once

#include <optional>
#include <string>
#include <vector>

#include "controller/runlog/run_list.h"

namespace flexarm {

/// Which runs of a list are asked for. All that is given must hold.
struct RunSearch {
  std::vector<std::string> text;  ///< each in name, note, a tag, experiment or file; ASCII letters
                                  ///< of either case
  std::vector<std::string> tag;   ///< each is one of the tags
  std::string law;                ///< controller.name; empty: any
  std::optional<std::string> trip;  ///< name of the cause, or "any"
};

/// Whether a run that can be read is one of those.
bool Matches(const ListedRun& run, const RunSearch& search);

}  // namespace flexarm
