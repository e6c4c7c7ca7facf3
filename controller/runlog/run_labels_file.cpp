#include "controller/runlog/run_labels_file.h"

#include <fcntl.h>
#include <sys/file.h>

#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>

#include "controller/files/external_file.h"
#include "controller/files/external_json.h"
#include "controller/files/external_text.h"
#include "controller/files/input_error.h"
#include "controller/files/write_file.h"
#include "controller/runlog/file_descriptor.h"
#include "controller/runlog/run_label.h"
#include "controller/runlog/run_list.h"

namespace flexarm {
namespace {

constexpr const char* kFileName = "flexarm-labels.json";
constexpr const char* kMark = "flexarm_labels";
constexpr FileKind kLabelsFile{"the labels of the run logs of this folder", 16 * kMiB,
                               FileSyntax::kJson};

std::filesystem::path FolderOf(const std::filesystem::path& run) {
  return run.has_parent_path() ? run.parent_path() : ".";
}

// Of the folder, until the end of the process's change. The file itself is replaced.
FileDescriptor LockOf(const std::filesystem::path& folder) {
  FileDescriptor lock(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!lock.is_open() || ::flock(lock.get(), LOCK_EX) != 0) {
    throw InputError(Shown(folder.string(), kMessageBytes) + ": " + std::strerror(errno) +
                     "; expected the folder of a run log");
  }
  return lock;
}

}  // namespace

RunLabel RunLabels::Of(const std::string& file_name, const RunLabel& of_log) const {
  const auto found = by_file.find(file_name);
  return found == by_file.end() ? of_log : found->second;
}

RunLabels ReadRunLabels(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / kFileName;
  RunLabels labels;
  if (!std::filesystem::exists(file)) return labels;
  const auto fail = [&](const std::string& found) {
    throw InputError(Shown(file.string(), kMessageBytes) + ": found " + found + ", expected " +
                     kLabelsFile.name +
                     "; without this file the logs have the labels of their runs");
  };
  const nlohmann::json json =
      ParseJson(ReadExternalText(file, kLabelsFile), file.string(), kLabelsFile.name);
  if (!json.is_object() || json.value(kMark, nlohmann::json()) != 1 || !json.contains("runs") ||
      !json["runs"].is_object()) {
    fail("another JSON file");
  }
  for (const auto& [name, value] : json["runs"].items()) {
    const std::optional<RunLabel> label = LabelOfJson(value);
    if (!label || !ProblemOfLabel(*label).empty()) fail("no label at '" + Shown(name) + "'");
    labels.by_file[name] = *label;
  }
  return labels;
}

RunLabel ChangeLabel(const std::filesystem::path& run,
                     const std::function<void(RunLabel*)>& change) {
  const std::filesystem::path folder = FolderOf(run);
  const std::string name = run.filename().string();
  const RunLabel of_log = ReadRunHead(run).info.label;
  const FileDescriptor lock = LockOf(folder);
  RunLabels labels = ReadRunLabels(folder);
  RunLabel label = labels.Of(name, of_log);
  change(&label);
  if (const std::string problem = ProblemOfLabel(label); !problem.empty()) {
    throw InputError(Shown(run.string(), kMessageBytes) + ": " + problem);
  }
  labels.by_file[name] = label;
  nlohmann::ordered_json json = {{kMark, 1}, {"runs", nlohmann::ordered_json::object()}};
  for (const auto& [file, changed] : labels.by_file) json["runs"][file] = LabelToJson(changed);
  WriteFile(folder / kFileName, json.dump(1) + "\n", ReplaceAny("labels of runs"));
  return label;
}

}  // namespace flexarm
