#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>

#include "controller/types/records.h"

namespace flexarm {

/// Labels that were changed after their runs: file `flexarm-labels.json` of the folder of the logs.
/// A log is never written again.
///
/// JSON: {"flexarm_labels": 1, "runs": {"<file name of the log>": label}}. A label there stands in
/// place of that in the log.
struct RunLabels {
  std::map<std::string, RunLabel> by_file;

  /// @param of_log  what the log says
  RunLabel Of(const std::string& file_name, const RunLabel& of_log) const;
};

/// None, if the folder has no such file. @throws InputError if it is no file of labels
RunLabels ReadRunLabels(const std::filesystem::path& folder);

/// Changes the label of a run, in the file of its folder, which is replaced as a whole. One process
/// at a time: another one waits.
/// @throws InputError: the log cannot be read, the label is refused, the file cannot be written
RunLabel ChangeLabel(const std::filesystem::path& run,
                     const std::function<void(RunLabel*)>& change);

}  // namespace flexarm
