#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "controller/types/records.h"

namespace flexarm {

// How users call a run: in the log, in the command `run`, and in the file of labels of a folder.
// JSON: {"name": text, "note": text, "tags": [texts]}. Not real-time safe.

inline constexpr std::size_t kLongestName = 80;  ///< bytes
inline constexpr std::size_t kLongestNote = 1000;
inline constexpr std::size_t kLongestTag = 40;
inline constexpr std::size_t kMostTags = 20;

/// Why a label is refused: a text that is no line of at most so many bytes (one_line.h), too many
/// tags; "" if it is not.
std::string ProblemOfLabel(const RunLabel& label);

nlohmann::json LabelToJson(const RunLabel& label);
/// Empty if it is no such object. A key that is missing is an empty one.
std::optional<RunLabel> LabelOfJson(const nlohmann::json& json);
/// Of JSON text from a file, which may hold anything; an empty label if it is none.
RunLabel LabelOfText(const std::string& text);

/// RunEvent::value_json of an announced experiment.
/// @param number  of the request for its run; 0: the next one
std::string Announcement(std::uint32_t number, const RunLabel& label);
RunLabel LabelOfAnnouncement(const RunEvent& announced);

}  // namespace flexarm
