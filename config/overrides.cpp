#include "config/overrides.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstddef>
#include <optional>
#include <string_view>
#include <utility>

#include "config/document.h"

namespace flexarm {
namespace {

bool IsKeyLetter(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-';
}

bool IsWordLetter(char c) {
  return static_cast<unsigned char>(c) > ' ' &&
         std::string_view("\"'[]{}#,=\\").find(c) == std::string_view::npos;
}

std::string_view Trimmed(std::string_view text) {
  const auto is_space = [](char c) { return c == ' ' || c == '\t'; };
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

// A table with the single key `key` (dotted: nested tables); empty if the text is not TOML. One
// line only: a second line could set another key.
std::optional<toml::table> ParseAssignment(const std::string& key, std::string_view value) {
  if (std::count(key.begin(), key.end(), '.') > 8) return std::nullopt;
  if (value.find('\n') != std::string_view::npos) return std::nullopt;
  try {
    return ParseToml(key + " = " + std::string(value), std::string(kOverrideSource));
  } catch (const ConfigError&) {
    return std::nullopt;
  }
}

std::optional<toml::table> ParseOverride(const std::string& key, std::string_view value) {
  if (auto parsed = ParseAssignment(key, value)) return parsed;
  const bool one_word = !value.empty() && std::all_of(value.begin(), value.end(), IsWordLetter);
  if (!one_word) return std::nullopt;
  return ParseAssignment(key, std::string("\"").append(value).append("\""));
}

// One name of a path, with an optional index: "strain[3]".
struct Step {
  std::string name;
  std::optional<std::size_t> index;
};

std::optional<Step> ParseStep(std::string_view text) {
  const std::size_t bracket = text.find('[');
  Step step{std::string(text.substr(0, bracket)), std::nullopt};
  if (step.name.empty() || !std::all_of(step.name.begin(), step.name.end(), IsKeyLetter)) {
    return std::nullopt;
  }
  if (bracket == std::string_view::npos) return step;
  std::size_t index = 0;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data() + bracket + 1, end, index);
  if (error != std::errc() || std::string_view(rest, end) != "]") return std::nullopt;
  step.index = index;
  return step;
}

std::optional<std::vector<Step>> ParsePath(std::string_view path) {
  std::vector<Step> steps;
  for (std::size_t dot = 0; dot != std::string_view::npos;) {
    dot = path.find('.');
    const std::optional<Step> step = ParseStep(path.substr(0, dot));
    if (!step) return std::nullopt;
    steps.push_back(*step);
    if (dot != std::string_view::npos) path.remove_prefix(dot + 1);
  }
  return steps;
}

// Replaces an element in place, which keeps the source of the new one.
void ReplaceElement(toml::array* array, std::size_t index, toml::node&& value) {
  const auto at = array->erase(array->cbegin() + static_cast<std::ptrdiff_t>(index));
  array->insert(at, std::move(value));
}

// The array at the end of `names` below `table`, if it is long enough for `index`.
toml::array* FindArray(toml::table* table, const std::vector<std::string>& names,
                       std::size_t index) {
  toml::node* node = table;
  for (const std::string& name : names) {
    toml::table* inner = node->as_table();
    node = inner != nullptr ? inner->get(name) : nullptr;
    if (node == nullptr) return nullptr;
  }
  toml::array* array = node->as_array();
  return array != nullptr && index < array->size() ? array : nullptr;
}

// Sets the value. @returns the problem if that is not possible
std::optional<std::string> Apply(const std::vector<Step>& steps, std::string_view value,
                                 toml::table* table) {
  std::vector<std::string> names;  // names since the last index
  for (std::size_t i = 0; i < steps.size(); ++i) {
    names.push_back(steps[i].name);
    if (!steps[i].index) continue;
    toml::array* array = FindArray(table, names, *steps[i].index);
    if (array == nullptr) return "there is no such row or element";
    names.clear();
    if (i + 1 == steps.size()) {
      std::optional<toml::table> parsed = ParseOverride("value", value);
      if (!parsed) return "VALUE must be one TOML value or one word";
      ReplaceElement(array, *steps[i].index, std::move(*parsed->get("value")));
      return std::nullopt;
    }
    table = array->get(*steps[i].index)->as_table();
    if (table == nullptr) return "there is no such row or element";
  }
  std::string key;
  for (const std::string& name : names) key += (key.empty() ? "" : ".") + name;
  std::optional<toml::table> parsed = ParseOverride(key, value);
  if (!parsed) return "VALUE must be one TOML value or one word";
  Merge(table, std::move(*parsed));
  return std::nullopt;
}

}  // namespace

void ApplyOverrides(const std::vector<std::string>& overrides, toml::table* document,
                    ProblemLog* log) {
  for (const std::string& text : overrides) {
    const std::size_t equals = text.find('=');
    const auto steps = ParsePath(Trimmed(std::string_view(text).substr(0, equals)));
    if (equals == std::string::npos || !steps) {
      log->AddOverride(text, "must be section.key=VALUE");
      continue;
    }
    const std::string_view value = Trimmed(std::string_view(text).substr(equals + 1));
    if (const auto wrong = Apply(*steps, value, document)) log->AddOverride(text, *wrong);
  }
}

}  // namespace flexarm
