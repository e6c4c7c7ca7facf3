#include "tools/identification/changed_lines.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <tuple>
#include <utility>

#include "config/shown_config.h"
#include "controller/types/rounded_text.h"

namespace flexarm {
namespace {

constexpr int kFewestDigits = 3, kMostDigits = 8;

// To a tenth of the standard error, at least to three digits.
std::string FoundText(const FoundParameter& parameter) {
  const double ratio = std::fabs(parameter.found) / parameter.standard_error;
  int digits = kFewestDigits;
  if (std::isfinite(ratio) && ratio > 1.0) {
    digits =
        std::clamp(static_cast<int>(std::ceil(std::log10(ratio))) + 1, kFewestDigits, kMostDigits);
  }
  return RoundedText(parameter.found, digits);
}

std::string HowFound(const FoundParameter& parameter) {
  std::string how = "identified";
  if (parameter.at_bound) how += ", at its bound";
  if (!std::isfinite(parameter.standard_error)) return how + ", not determined by this run";
  return how + ", +- " + RoundedText(parameter.standard_error, 2);
}

// "[joint1]", or "[[link1.section]], row 0".
std::string SectionOf(const std::string& key) {
  const std::string table = key.substr(0, key.rfind('.'));
  if (!table.ends_with(']')) return "[" + table + "]";
  const std::size_t bracket = table.rfind('[');
  return "[[" + table.substr(0, bracket) + "]], row " +
         table.substr(bracket + 1, table.size() - bracket - 2);
}

std::string PlaceText(const ChangedLine& changed) {
  if (changed.file.empty()) return SectionOf(changed.value.key);
  const std::string line = changed.line > 0 ? ":" + std::to_string(changed.line) : "";
  return changed.file + line + ": " + SectionOf(changed.value.key);
}

// Lines that a file does not have are left out: they follow by themselves.
std::vector<ChangedLine> Placed(const std::vector<ChangedValue>& values,
                                const std::vector<ShownValue>& shown, bool has_file) {
  std::vector<ChangedLine> lines;
  for (const ChangedValue& value : values) {
    const auto at = std::find_if(shown.begin(), shown.end(),
                                 [&](const ShownValue& s) { return s.key == value.key; });
    if (!has_file) lines.push_back({.value = value, .file = {}, .line = 0});
    if (at == shown.end() || at->file.empty()) continue;
    lines.push_back({.value = value, .file = at->file, .line = at->line});
  }
  std::stable_sort(lines.begin(), lines.end(), [](const ChangedLine& a, const ChangedLine& b) {
    return std::tie(a.file, a.line) < std::tie(b.file, b.line);
  });
  return lines;
}

}  // namespace

RigConfig WithFoundValues(const RigConfig& start, const Identification& found) {
  std::vector<std::string> values;
  for (const FoundParameter& parameter : found.parameter) {
    values.push_back(parameter.free.key + "=" + FoundText(parameter));
  }
  return WithOverrides(start, values);
}

std::vector<ChangedLine> ChangedLines(const RigConfig& start, const Identification& found,
                                      const std::filesystem::path& file,
                                      const std::vector<std::string>& overrides) {
  const RigConfig changed = WithFoundValues(start, found);
  std::vector<ChangedValue> values;
  for (const FoundParameter& parameter : found.parameter) {
    const std::string key = LineKeyOf(parameter.free.key);
    values.push_back({.key = key,
                      .before = ValueTextAt(start, key),
                      .after = ValueTextAt(changed, key),
                      .how = HowFound(parameter)});
  }
  const bool has_file = !file.empty();
  const std::vector<ShownValue> shown =
      has_file ? ShownConfig(file, overrides) : std::vector<ShownValue>{};
  std::vector<ChangedLine> lines = Placed(values, shown, has_file);
  std::vector<ChangedValue> following = FollowingKeys(start, changed);
  for (ChangedValue& value : following) value.how = "derived: " + value.how;
  for (ChangedLine& line : Placed(following, shown, has_file)) lines.push_back(std::move(line));
  return lines;
}

std::string LinesText(const std::vector<ChangedLine>& lines) {
  std::string text;
  for (const ChangedLine& line : lines) {
    const std::string name = line.value.key.substr(line.value.key.rfind('.') + 1);
    text += PlaceText(line) + "\n" + name + " = " + line.value.after + "  # " + line.value.how +
            "; was " + line.value.before + "\n";
  }
  return text;
}

nlohmann::ordered_json LinesJson(const std::vector<ChangedLine>& lines) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const ChangedLine& line : lines) {
    json.push_back({{"file", line.file},
                    {"line", line.line},
                    {"key", line.value.key},
                    {"before", line.value.before},
                    {"after", line.value.after},
                    {"how", line.value.how}});
  }
  return json;
}

}  // namespace flexarm
