#include "controller/runlog/run_list.h"

#include <fcntl.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <system_error>
#include <variant>

#include "controller/files/external_file.h"
#include "controller/files/external_text.h"
#include "controller/files/input_error.h"
#include "controller/files/nesting.h"
#include "controller/runlog/file_descriptor.h"
#include "controller/runlog/record_file_reader.h"
#include "controller/runlog/run_file_lock.h"
#include "controller/runlog/run_info_keys.h"
#include "controller/runlog/run_labels_file.h"

namespace flexarm {
namespace {

// A result may have been changed: it need not be what the recorder writes.
void ReadResult(RunHead* head) {
  const std::string& text = head->info.result_json;
  if (text.empty() || LineNestedTooDeepJson(text) != 0) return;
  const nlohmann::json result = nlohmann::json::parse(text, nullptr, false);
  if (!result.is_object()) return;
  const auto is_set = [&result](const char* key) {
    const auto found = result.find(key);
    return found != result.end() && found->is_boolean() && found->get<bool>();
  };
  if (const auto trip = result.find("trip"); trip != result.end() && trip->is_string()) {
    head->trip = trip->get<std::string>();
  }
  if (const auto time = result.find("duration_s"); time != result.end() && time->is_number()) {
    head->duration_s = time->get<double>();
  }
  head->end = !head->trip.empty()   ? RunEnd::kTripped
              : is_set("recovered") ? RunEnd::kCutShort
              : is_set("stopped")   ? RunEnd::kStopped
                                    : RunEnd::kComplete;
}

// The keys stand first in a record file. Its samples, perhaps those of hours, stay unread.
RunHead HeadOfRecords(int fd, const std::filesystem::path& file) {
  RunHead head{.info = {},
               .state = RunFileIsLocked(fd) ? RunState::kWritten : RunState::kLeft,
               .trip = {},
               .duration_s = {}};
  RecordFileReader records(fd);
  if (!records.problem().empty()) {
    throw InputError(Shown(file.string(), kMessageBytes) + ": " + records.problem());
  }
  while (const std::optional<RunRecord> record = records.Next()) {
    const auto* key = std::get_if<InfoRecord>(&*record);
    if (key == nullptr) break;
    SetInfo(&head.info, key->key, key->value);
  }
  return head;
}

}  // namespace

const char* ToString(RunEnd end) {
  switch (end) {
    case RunEnd::kOpen:
      return "open";
    case RunEnd::kComplete:
      return "complete";
    case RunEnd::kStopped:
      return "stopped";
    case RunEnd::kTripped:
      return "tripped";
    case RunEnd::kCutShort:
      return "cut-short";
  }
  return "";
}

RunHead ReadRunHead(const std::filesystem::path& file) {
  if (Beginning(file, kRecordMagic.size()) == kRecordMagic) {
    const FileDescriptor fd(::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
    if (fd.is_open()) return HeadOfRecords(fd.get(), file);
  }
  const RunReader reader(file);
  RunHead head{.info = reader.info(), .state = reader.state(), .trip = {}, .duration_s = {}};
  ReadResult(&head);
  return head;
}

std::vector<ListedRun> ListRuns(const std::filesystem::path& folder) {
  const RunLabels labels = ReadRunLabels(folder);
  std::vector<ListedRun> runs;
  std::error_code error;
  for (std::filesystem::directory_iterator at(folder, error), end; !error && at != end;
       at.increment(error)) {
    const std::string name = at->path().filename().string();
    if (at->path().extension() != ".flexarm" || name.starts_with('.')) continue;
    ListedRun run{.file = at->path(), .problem = {}, .head = {}, .label = {}};
    try {
      run.head = ReadRunHead(run.file);
      run.label = labels.Of(name, run.head.info.label);
    } catch (const InputError& problem) {
      run.problem = problem.what();
    }
    runs.push_back(std::move(run));
  }
  if (error) {
    throw InputError(Shown(folder.string(), kMessageBytes) + ": " + error.message() +
                     "; expected the folder of the run logs: name it with --folder");
  }
  std::ranges::sort(runs, [](const ListedRun& a, const ListedRun& b) {
    if (a.problem.empty() != b.problem.empty()) return a.problem.empty();
    if (a.head.info.start_utc != b.head.info.start_utc) {
      return a.head.info.start_utc > b.head.info.start_utc;
    }
    return a.file > b.file;
  });
  return runs;
}

std::filesystem::path NewestRun(const std::filesystem::path& folder) {
  const std::vector<ListedRun> runs = ListRuns(folder);
  if (!runs.empty() && runs.front().problem.empty()) return runs.front().file;
  throw InputError(Shown(folder.string(), kMessageBytes) +
                   ": has no run log that can be read; expected one: `flexarm runs` lists them");
}

}  // namespace flexarm
