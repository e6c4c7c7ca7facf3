#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

// Reads the command lines of clients, which may hold anything. Pure functions. Not real-time safe.

namespace flexarm {

/// Brackets within brackets that a command may have. Copying or writing JSON takes stack for each.
inline constexpr int kMostDepth = 32;
/// Values in all. Each takes memory and time when it is read; a command has some ten.
inline constexpr int kMostValues = 256;

/// The JSON object of a line, if it is one with a text "command", and not deeper than kMostDepth;
/// and has no more than kMostValues; both are counted before the line is parsed.
std::optional<nlohmann::json> ParseCommand(const std::string& line);

/// The text of a key; `otherwise` if the key is not there.
/// @throws RejectedError if it is something else
std::string TextOf(const nlohmann::json& command, const char* key, const std::string& otherwise);

}  // namespace flexarm
