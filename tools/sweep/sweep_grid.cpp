#include "tools/sweep/sweep_grid.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "controller/runlog/errors.h"

namespace flexarm {
namespace {

constexpr std::size_t kMostPoints = 1'000'000;  // more is a typing error in a range

template <typename Number>
std::optional<Number> NumberIn(std::string_view text) {
  Number value{};
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || rest != end) return std::nullopt;
  return value;
}

std::string Trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return std::string(text);
}

std::vector<std::string> SplitList(const std::string& text) {
  std::vector<std::string> parts(1);
  int depth = 0;
  char quote = '\0';
  for (const char c : text) {
    if (quote == '\0' && (c == '"' || c == '\'')) {
      quote = c;
    } else if (c == quote) {
      quote = '\0';
    }
    if (quote == '\0' && (c == '[' || c == '{')) ++depth;
    if (quote == '\0' && (c == ']' || c == '}')) --depth;
    if (c == ',' && depth == 0 && quote == '\0') {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  for (std::string& part : parts) part = Trimmed(part);
  return parts;
}

void CheckLength(double count, const std::string& text) {
  if (count >= 0.0 && count < static_cast<double>(kMostPoints)) return;
  throw InputError(text + ": the range is empty or endless; expected a step from FROM towards TO");
}

// The values of FROM:STEP:TO; nothing if the text has another form.
std::optional<std::vector<std::string>> StepRange(const std::string& text) {
  const std::size_t first = text.find(':'), second = text.find(':', first + 1);
  if (second == std::string::npos) return std::nullopt;
  const auto from = NumberIn<double>(std::string_view(text).substr(0, first));
  const auto step = NumberIn<double>(std::string_view(text).substr(first + 1, second - first - 1));
  const auto to = NumberIn<double>(std::string_view(text).substr(second + 1));
  if (!from || !step || !to) return std::nullopt;
  // 1e-9 covers the rounding of a decimal step such as 0.1.
  const double steps = std::floor((*to - *from) / *step + 1e-9);
  CheckLength(steps, text);
  std::vector<std::string> values;
  for (int i = 0; i <= static_cast<int>(steps); ++i) {
    std::array<char, 32> value{};
    std::snprintf(value.data(), value.size(), "%.12g", *from + i * *step);
    values.emplace_back(value.data());
  }
  return values;
}

// The values of FIRST..LAST; nothing if the text has another form.
std::optional<std::vector<std::string>> WholeRange(const std::string& text) {
  const std::size_t dots = text.find("..");
  if (dots == std::string::npos) return std::nullopt;
  const auto first = NumberIn<std::int64_t>(std::string_view(text).substr(0, dots));
  const auto last = NumberIn<std::int64_t>(std::string_view(text).substr(dots + 2));
  if (!first || !last) return std::nullopt;
  CheckLength(static_cast<double>(*last) - static_cast<double>(*first), text);
  std::vector<std::string> values;
  for (std::int64_t i = *first; i <= *last; ++i) values.push_back(std::to_string(i));
  return values;
}

}  // namespace

const char* ToString(AxisTarget target) noexcept {
  switch (target) {
    case AxisTarget::kConfig:
      return "config";
    case AxisTarget::kPlant:
      return "plant";
    case AxisTarget::kVariant:
      return "variant";
    case AxisTarget::kPayload:
      return "payload_kg";
    case AxisTarget::kScenario:
      return "scenario";
    case AxisTarget::kSeed:
      return "seed";
  }
  return "?";
}

std::string SweepAxis::Column() const {
  if (target == AxisTarget::kConfig) return key;
  return target == AxisTarget::kPlant ? "plant:" + key : ToString(target);
}

std::vector<std::string> ParseValues(const std::string& text) {
  if (auto range = StepRange(text)) return *range;
  if (auto range = WholeRange(text)) return *range;
  std::vector<std::string> values = SplitList(text);
  std::set<std::string> seen;
  for (const std::string& value : values) {
    if (value.empty()) throw InputError("\"" + text + "\": an empty value; expected v1,v2,..");
    if (!seen.insert(value).second) throw InputError(text + ": " + value + " is given twice");
  }
  return values;
}

SweepAxis ParseAxis(AxisTarget target, const std::string& text) {
  const std::size_t equals = text.find('=');
  const std::string key = Trimmed(std::string_view(text).substr(0, equals));
  if (equals == std::string::npos || key.empty()) {
    throw InputError(text + ": expected KEY=v1,v2,.. or KEY=FROM:STEP:TO");
  }
  return {.target = target, .key = key, .values = ParseValues(Trimmed(text.substr(equals + 1)))};
}

SweepGrid::SweepGrid(std::vector<SweepAxis> axes) : axes_(std::move(axes)) {
  std::set<std::string> columns;
  for (const SweepAxis& axis : axes_) {
    if (!columns.insert(axis.Column()).second) {
      throw InputError(axis.Column() + ": is swept twice; expected one list");
    }
    size_ *= axis.values.size();
    if (size_ > kMostPoints) throw InputError("the sweep has more than a million points");
  }
}

std::vector<std::size_t> SweepGrid::Indices(std::size_t point) const {
  std::vector<std::size_t> indices(axes_.size());
  for (std::size_t i = axes_.size(); i-- > 0; point /= axes_[i].values.size()) {
    indices[i] = point % axes_[i].values.size();
  }
  return indices;
}

std::vector<std::string> SweepGrid::Values(std::size_t point) const {
  const std::vector<std::size_t> indices = Indices(point);
  std::vector<std::string> values;
  for (std::size_t i = 0; i < axes_.size(); ++i) values.push_back(axes_[i].values[indices[i]]);
  return values;
}

Shard ParseShard(const std::string& text) {
  const std::size_t slash = text.find('/');
  if (slash != std::string::npos) {
    const auto number = NumberIn<std::size_t>(std::string_view(text).substr(0, slash));
    const auto count = NumberIn<std::size_t>(std::string_view(text).substr(slash + 1));
    if (number && count && *number >= 1 && *number <= *count) return {*number, *count};
  }
  throw InputError("--shard " + text + ": expected I/N with 1 <= I <= N");
}

}  // namespace flexarm
