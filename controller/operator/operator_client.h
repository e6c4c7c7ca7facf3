#pragma once

#include <string>

namespace flexarm {

/// Client side of the operator socket: sends one line to the daemon at `path`, waits for its
/// answer, and returns it without its newline. Blocks for up to `timeout_s` after every byte.
/// @throws RejectedError saying what to do if no daemon answers within `timeout_s`
std::string AskDaemon(const std::string& path, const std::string& line, double timeout_s);

}  // namespace flexarm
