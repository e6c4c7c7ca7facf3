#include "controller/runlog/run_label.h"

#include <nlohmann/json.hpp>

#include "controller/files/nesting.h"
#include "controller/files/one_line.h"

namespace flexarm {
namespace {

// A text that may be missing.
std::string ProblemOf(const char* what, const std::string& text, std::size_t most_bytes) {
  const std::string problem = text.empty() ? "" : ProblemOfLine(text, most_bytes);
  return problem.empty() ? "" : std::string("the ") + what + " " + problem;
}

bool ReadText(const nlohmann::json& object, const char* key, std::string* text) {
  const auto found = object.find(key);
  if (found == object.end()) return true;
  if (!found->is_string()) return false;
  *text = found->get<std::string>();
  return true;
}

}  // namespace

std::string ProblemOfLabel(const RunLabel& label) {
  if (std::string problem = ProblemOf("name", label.name, kLongestName); !problem.empty()) {
    return problem;
  }
  if (std::string problem = ProblemOf("note", label.note, kLongestNote); !problem.empty()) {
    return problem;
  }
  for (const std::string& tag : label.tags) {
    const std::string problem = ProblemOfLine(tag, kLongestTag);
    if (!problem.empty()) return "a tag " + problem;
  }
  if (label.tags.size() > kMostTags) {
    return "has " + std::to_string(label.tags.size()) + " tags, expected at most " +
           std::to_string(kMostTags);
  }
  return {};
}

nlohmann::json LabelToJson(const RunLabel& label) {
  return {{"name", label.name}, {"note", label.note}, {"tags", label.tags}};
}

std::optional<RunLabel> LabelOfJson(const nlohmann::json& json) {
  RunLabel label;
  if (!json.is_object() || !ReadText(json, "name", &label.name) ||
      !ReadText(json, "note", &label.note)) {
    return std::nullopt;
  }
  const auto tags = json.find("tags");
  if (tags == json.end()) return label;
  if (!tags->is_array()) return std::nullopt;
  for (const nlohmann::json& tag : *tags) {
    if (!tag.is_string()) return std::nullopt;
    label.tags.push_back(tag.get<std::string>());
  }
  return label;
}

RunLabel LabelOfText(const std::string& text) {
  if (LineNestedTooDeepJson(text) != 0) return {};
  const nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
  return json.is_discarded() ? RunLabel{} : LabelOfJson(json).value_or(RunLabel{});
}

std::string Announcement(std::uint32_t number, const RunLabel& label) {
  return nlohmann::json{{"number", number}, {"label", LabelToJson(label)}}.dump();
}

RunLabel LabelOfAnnouncement(const RunEvent& announced) {
  if (announced.value_json.empty()) return {};
  const nlohmann::json json = nlohmann::json::parse(announced.value_json);
  return LabelOfJson(json.value("label", nlohmann::json::object())).value_or(RunLabel{});
}

}  // namespace flexarm
