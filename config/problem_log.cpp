#include "config/problem_log.h"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <optional>
#include <utility>

#include "config/document.h"
#include "config/spelling.h"
#include "config/toml_text.h"
#include "model/problem_list.h"

namespace flexarm {
namespace {

// "sensors" is at or above "sensors", "sensors.encoder" and "sensors[1]", not above "sensors2".
bool IsAtOrAbove(std::string_view above, std::string_view key) {
  if (!key.starts_with(above)) return false;
  return key.size() == above.size() || key[above.size()] == '.' || key[above.size()] == '[';
}

const toml::node* Child(const toml::node& parent, std::string_view segment) {
  const std::size_t bracket = segment.find('[');
  const toml::table* table = parent.as_table();
  const toml::node* child = table != nullptr ? table->get(segment.substr(0, bracket)) : nullptr;
  if (child == nullptr || bracket == std::string_view::npos) return child;
  std::size_t index = 0;
  std::from_chars(segment.data() + bracket + 1, segment.data() + segment.size(), index);
  const toml::array* array = child->as_array();
  const toml::node* element = array != nullptr ? array->get(index) : nullptr;
  return element != nullptr ? element : child;
}

// Shortens a text to at most 60 bytes, without splitting a UTF-8 character.
std::string Shortened(std::string text) {
  constexpr std::size_t kLongest = 60;
  if (text.size() <= kLongest) return text;
  std::size_t end = kLongest;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0U) == 0x80U) --end;
  return text.substr(0, end) + "...";
}

}  // namespace

std::string JoinKey(const std::string& path, std::string_view key) {
  return path.empty() ? std::string(key) : path + "." + std::string(key);
}

ProblemLog::ProblemLog(std::string file, const toml::table* document)
    : file_(std::move(file)), document_(document) {}

void ProblemLog::Know(const std::string& path, std::string_view key) {
  std::vector<std::string>& keys = known_[path];
  if (std::find(keys.begin(), keys.end(), key) == keys.end()) keys.emplace_back(key);
}

void ProblemLog::AddMissing(const std::string& path, std::string_view key,
                            std::string_view wanted) {
  reported_.push_back(JoinKey(path, key));
  if (std::find(excused_.begin(), excused_.end(), reported_.back()) != excused_.end()) return;
  missing_.push_back({path, std::string(key), std::string(wanted)});
}

void ProblemLog::Excuse(std::vector<std::string> keys) { excused_ = std::move(keys); }

void ProblemLog::Add(const std::string& key, const toml::node& node, std::string rule) {
  reported_.push_back(key);
  problems_.push_back(Placed(&node, key, ValueText(node), std::move(rule)));
}

void ProblemLog::AddOverride(const std::string& override_text, std::string rule) {
  problems_.push_back({std::string(kOverrideSource), 0, override_text, "", std::move(rule)});
}

void ProblemLog::AddRules(const std::vector<Problem>& problems) {
  std::vector<std::string> broken;
  for (const Problem& p : problems) {
    if (!Clear({p.key})) continue;
    problems_.push_back(Placed(Locate(p.key), p.key, p.value, p.rule));
    broken.push_back(p.key);
  }
  // Added after the loop: a value may violate two rules of its struct.
  reported_.insert(reported_.end(), broken.begin(), broken.end());
}

bool ProblemLog::Clear(std::initializer_list<std::string_view> keys) const {
  return std::none_of(keys.begin(), keys.end(), [this](std::string_view key) {
    return std::any_of(reported_.begin(), reported_.end(), [key](const std::string& reported) {
      return IsAtOrAbove(reported, key) || IsAtOrAbove(key, reported);
    });
  });
}

void ProblemLog::AddUnknown() { AddUnknownIn(*document_, ""); }

void ProblemLog::AddUnknownIn(const toml::table& table, const std::string& path) {
  const auto known = known_.find(path);
  if (known == known_.end()) return;  // no reader for this table: the table itself is reported
  for (const auto& [key, node] : table) {
    const std::vector<std::string>& keys = known->second;
    if (std::find(keys.begin(), keys.end(), key.str()) == keys.end()) {
      AddUnknownKey(path, key.str(), node);
    } else if (const toml::table* section = node.as_table()) {
      AddUnknownIn(*section, JoinKey(path, key.str()));
    } else if (const toml::array* rows = node.as_array()) {
      for (std::size_t i = 0; i < rows->size(); ++i) {
        const toml::table* row = rows->get(i)->as_table();
        if (row != nullptr) AddUnknownIn(*row, ProblemList::Element(JoinKey(path, key.str()), i));
      }
    }
  }
}

void ProblemLog::AddUnknownKey(const std::string& path, std::string_view key,
                               const toml::node& node) {
  const std::string value = node.is_table() ? "" : ValueText(node);
  problems_.push_back(
      Placed(&node, JoinKey(path, KeyText(key)), value, "unknown key; " + Suggestion(path, key)));
}

std::string ProblemLog::Suggestion(const std::string& path, std::string_view key) {
  const std::vector<std::string>& keys = known_.at(path);
  if (const std::optional<std::string> meant = ClosestWord(key, keys)) {
    // A misspelt key is one problem: it is not reported as missing too.
    const auto erased = std::erase_if(
        missing_, [&](const Missing& m) { return m.path == path && m.key == *meant; });
    return "did you mean \"" + *meant + (erased > 0 ? "\", which is missing?" : "\"?");
  }
  for (const auto& [other, its_keys] : known_) {
    const bool has = std::find(its_keys.begin(), its_keys.end(), key) != its_keys.end();
    if (has && !other.empty()) return "did you mean " + JoinKey(other, key) + "?";
  }
  std::string list = "known here:";
  for (const std::string& known : keys) list += " " + known;
  return list;
}

void ProblemLog::ThrowIfAny() {
  for (const Missing& m : missing_) {
    const toml::node* table = m.path.empty() ? nullptr : Locate(m.path);
    problems_.push_back(
        Placed(table, JoinKey(m.path, m.key), "", "missing: must be there and be " + m.wanted));
  }
  missing_.clear();
  std::stable_sort(problems_.begin(), problems_.end(), [](const auto& a, const auto& b) {
    return std::pair(std::string_view(a.file), a.line) <
           std::pair(std::string_view(b.file), b.line);
  });
  if (!problems_.empty()) throw ConfigError(std::move(problems_));
}

ConfigProblem ProblemLog::Placed(const toml::node* node, std::string key, std::string value,
                                 std::string rule) const {
  ConfigPlace place = PlaceOfNode(node);
  return {std::move(place.file), place.line, Shortened(std::move(key)), Shortened(std::move(value)),
          std::move(rule)};
}

ConfigPlace ProblemLog::PlaceOf(std::string_view key) const { return PlaceOfNode(Locate(key)); }

ConfigPlace ProblemLog::PlaceOfNode(const toml::node* node) const {
  if (node == nullptr || !node->source().path) return {file_, 0};
  const std::string& file = *node->source().path;
  const bool has_line = file != kOverrideSource;
  return {file, has_line ? static_cast<int>(node->source().begin.line) : 0};
}

// The deepest existing node on the path.
const toml::node* ProblemLog::Locate(std::string_view path) const {
  const toml::node* found = document_;
  while (!path.empty()) {
    const std::size_t dot = path.find('.');
    const toml::node* child = Child(*found, path.substr(0, dot));
    if (child == nullptr) break;
    found = child;
    path = dot == std::string_view::npos ? "" : path.substr(dot + 1);
  }
  return found == document_ ? nullptr : found;
}

}  // namespace flexarm
