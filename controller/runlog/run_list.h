#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "controller/runlog/run_reader.h"
#include "controller/types/records.h"

namespace flexarm {

/// How a run ended, as its result tells.
enum class RunEnd {
  kOpen,      ///< it has no result: it is being written, or its program was killed
  kComplete,  ///< as its experiment ends
  kStopped,   ///< by a command
  kTripped,
  kCutShort,  ///< recovered: its program was killed
};

const char* ToString(RunEnd end);

/// What stands at the beginning of a log: all but its samples, events and safety records.
struct RunHead {
  RunInfo info;
  RunState state = RunState::kClosed;
  RunEnd end = RunEnd::kOpen;
  std::string trip;                  ///< name of its cause; empty: none
  std::optional<double> duration_s;  ///< from the grant to the last sample
};

/// Reads it without reading the samples. @throws InputError as RunReader
RunHead ReadRunHead(const std::filesystem::path& file);

/// A file `*.flexarm` of a folder.
struct ListedRun {
  std::filesystem::path file;
  std::string problem;  ///< why it cannot be read; empty: it can
  RunHead head;
  RunLabel label;  ///< of the log, with what was changed afterwards (run_labels_file.h)
};

/// All of a folder, newest first; those that cannot be read last. Never throws for what a file
/// contains. @throws InputError if the folder, or its file of labels, cannot be read
std::vector<ListedRun> ListRuns(const std::filesystem::path& folder);

/// The newest run of a folder. @throws InputError the same; or if it has none
std::filesystem::path NewestRun(const std::filesystem::path& folder);

}  // namespace flexarm
