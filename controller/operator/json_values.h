#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace flexarm {

/// A text, or null where it is empty: nothing to say.
inline nlohmann::json TextOrNull(const std::string& text) {
  return text.empty() ? nlohmann::json(nullptr) : nlohmann::json(text);
}

}  // namespace flexarm
