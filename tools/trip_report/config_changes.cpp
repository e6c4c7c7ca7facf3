#include "tools/trip_report/config_changes.h"

#include <algorithm>
#include <map>
#include <sstream>
#include <system_error>

#include "config/document.h"
#include "controller/files/input_error.h"

namespace flexarm {
namespace {

using Values = std::map<std::string, std::string>;

void Flatten(const toml::node& node, const std::string& key, Values* values) {
  if (const toml::table* table = node.as_table()) {
    for (const auto& [name, child] : *table) {
      Flatten(child, key.empty() ? std::string(name.str()) : key + "." + std::string(name.str()),
              values);
    }
    return;
  }
  const toml::array* array = node.as_array();
  if (array != nullptr && !array->empty() && array->is_homogeneous<toml::table>()) {
    for (std::size_t i = 0; i < array->size(); ++i) {
      Flatten(*array->get(i), key + "[" + std::to_string(i) + "]", values);
    }
    return;
  }
  std::ostringstream text;
  node.visit([&text](const auto& value) { text << value; });
  (*values)[key] = text.str();
}

Values ValuesOf(const std::string& text, const char* name) {
  Values values;
  Flatten(ParseToml(text, name), "", &values);
  return values;
}

// Newest first, by the time at which they were last written.
std::vector<std::filesystem::path> LogsBefore(const std::filesystem::path& log) {
  std::error_code error;
  const auto own = std::filesystem::last_write_time(log, error);
  if (error) return {};
  const std::filesystem::path folder = log.has_parent_path() ? log.parent_path() : ".";
  std::vector<std::pair<std::filesystem::file_time_type, std::filesystem::path>> found;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::filesystem::path& file = entry.path();
    if (file.extension() != ".flexarm" || file.filename().string().starts_with('.')) continue;
    if (file.filename() == log.filename()) continue;
    const auto written = entry.last_write_time(error);
    if (!error && written <= own) found.emplace_back(written, file);
  }
  std::ranges::sort(found, std::ranges::greater{});
  std::vector<std::filesystem::path> logs;
  for (const auto& [written, file] : found) {
    if (logs.size() < kMostLooked) logs.push_back(file);
  }
  return logs;
}

}  // namespace

std::vector<ConfigChange> ConfigChanges(const std::string& before, const std::string& after) {
  const Values old_values = ValuesOf(before, "the config before"),
               new_values = ValuesOf(after, "the config");
  std::vector<ConfigChange> changes;
  for (const auto& [key, value] : old_values) {
    const auto now = new_values.find(key);
    const std::string text = now == new_values.end() ? "" : now->second;
    if (text != value) changes.push_back({.key = key, .before = value, .after = text});
  }
  for (const auto& [key, value] : new_values) {
    if (!old_values.contains(key)) changes.push_back({.key = key, .before = "", .after = value});
  }
  std::ranges::sort(changes, {}, &ConfigChange::key);
  return changes;
}

std::optional<GoodRun> GoodRunBefore(const std::filesystem::path& log, const RunInfo& info) {
  for (const std::filesystem::path& file : LogsBefore(log)) {
    try {
      RunHead head = ReadRunHead(file);
      const bool is_good = head.end == RunEnd::kComplete && head.info.rig_name == info.rig_name &&
                           head.info.start_utc <= info.start_utc;
      if (is_good) return GoodRun{.file = file, .head = std::move(head)};
    } catch (const InputError&) {  // what cannot be read says nothing
    }
  }
  return std::nullopt;
}

}  // namespace flexarm
