#include "controller/operator/override.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>

#include "controller/types/rejected_error.h"

namespace flexarm {
namespace {

// The code point at `*at`, which moves behind it; nothing if the bytes there are not UTF-8.
std::optional<char32_t> NextCodePoint(const std::string& text, std::size_t* at) {
  const auto byte = [&text](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
  const std::uint8_t first = byte(*at);
  const auto length = static_cast<std::size_t>(std::countl_one(first));
  if (length == 0) {
    ++*at;
    return first;
  }
  if (length < 2 || length > 4 || *at + length > text.size()) return std::nullopt;
  char32_t code = first & (0x7Fu >> length);
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(*at + i) & 0xC0u) != 0x80u) return std::nullopt;
    code = (code << 6) | (byte(*at + i) & 0x3Fu);
  }
  constexpr std::array<char32_t, 5> kLeast = {0, 0, 0x80, 0x800, 0x10000};
  if (code < kLeast[length] || code > 0x10FFFF || (code >= 0xD800 && code <= 0xDFFF)) {
    return std::nullopt;
  }
  *at += length;
  return code;
}

// Ends a line, moves the cursor, or changes how the text around it is shown.
bool IsControl(char32_t code) {
  const auto within = [code](char32_t first, char32_t last) {
    return code >= first && code <= last;
  };
  return code < 0x20 || within(0x7F, 0x9F) || within(0x200B, 0x200F) || within(0x2028, 0x202E) ||
         within(0x2060, 0x206F) || code == 0xFEFF;
}

}  // namespace

ConditionDecision Judge(const std::vector<UnmetCondition>& unmet,
                        const std::vector<Override>& overrides) {
  ConditionDecision decision{.refused = nullptr, .used = {}};
  for (const UnmetCondition& condition : unmet) {
    const auto given = std::find_if(overrides.begin(), overrides.end(), [&](const Override& o) {
      return o.condition == condition.name;
    });
    if (given == overrides.end() || !condition.may_override) {
      return {.refused = &condition, .used = {}};
    }
    decision.used.push_back(*given);
    decision.used.back().found = condition.found;
  }
  return decision;
}

std::string ProblemOfReason(const std::string& reason) {
  if (reason.size() > kLongestReason) {
    return "is longer than " + std::to_string(kLongestReason) + " bytes";
  }
  bool visible = false;
  for (std::size_t at = 0; at < reason.size();) {
    const std::optional<char32_t> code = NextCodePoint(reason, &at);
    if (!code) return "is not UTF-8";
    if (IsControl(*code)) return "contains a control character";
    visible = visible || (*code != ' ' && *code != 0xA0);
  }
  return visible ? "" : "is empty";
}

std::vector<Override> OverridesOf(const nlohmann::json& command,
                                  const std::vector<std::string>& conditions) {
  const auto given = command.find("overrides");
  if (given == command.end()) return {};
  if (!given->is_object()) throw RejectedError("overrides: must be an object of reasons");
  for (const auto& [name, reason] : given->items()) {
    if (std::find(conditions.begin(), conditions.end(), name) == conditions.end()) {
      throw RejectedError("overrides: this command has no such condition: '" + name + "'");
    }
    if (!reason.is_string()) throw RejectedError("overrides: the reason must be a text");
    if (const std::string problem = ProblemOfReason(reason.get<std::string>()); !problem.empty()) {
      throw RejectedError("overrides: the reason for '" + name + "' " + problem);
    }
  }
  std::vector<Override> overrides;
  for (const std::string& name : conditions) {
    if (given->contains(name)) {
      overrides.push_back({.condition = name, .reason = given->at(name).get<std::string>()});
    }
  }
  return overrides;
}

}  // namespace flexarm
