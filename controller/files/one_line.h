#pragma once

#include <cstddef>
#include <string>

namespace flexarm {

/// Why a text that a user gave cannot be a line of logs and tables: "is empty", "is not UTF-8",
/// "contains a control character" (also one that changes how the text around it is shown), "is
/// longer than .. bytes"; "" if it can. Real-time: no.
std::string ProblemOfLine(const std::string& text, std::size_t most_bytes);

}  // namespace flexarm
