#include "controller/operator/command_text.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "controller/types/rejected_error.h"

namespace flexarm {
namespace {

// Outside of strings: the deepest nesting of brackets, and how many values there can be.
struct Shape {
  int depth;
  int values;
};

Shape ShapeOf(const std::string& line) {
  int depth = 0, deepest = 0, values = 1;
  bool in_string = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (in_string) {
      if (c == '\\') ++i;
      in_string = c != '"';
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      deepest = std::max(deepest, ++depth);
      ++values;
    } else if (c == ']' || c == '}') {
      --depth;
    } else if (c == ',') {
      ++values;
    }
  }
  return {.depth = deepest, .values = values};
}

}  // namespace

std::optional<nlohmann::json> ParseCommand(const std::string& line) {
  const Shape shape = ShapeOf(line);
  if (shape.depth > kMostDepth || shape.values > kMostValues) return std::nullopt;
  nlohmann::json command = nlohmann::json::parse(line, nullptr, false);
  if (!command.is_object()) return std::nullopt;
  const auto name = command.find("command");
  if (name == command.end() || !name->is_string()) return std::nullopt;
  return command;
}

std::string TextOf(const nlohmann::json& command, const char* key, const std::string& otherwise) {
  const auto found = command.find(key);
  if (found == command.end()) return otherwise;
  if (!found->is_string()) throw RejectedError(std::string("expected a text in '") + key + "'");
  return found->get<std::string>();
}

}  // namespace flexarm
