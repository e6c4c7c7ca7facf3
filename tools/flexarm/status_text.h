#pragma once

#include <string>

#include "tools/flexarm/reply.h"

namespace flexarm {

/// What `flexarm status` prints: the answer to the command "status" for people. Of a daemon of
/// another version it shows what it knows. Pure function.
std::string StatusText(const Reply& status);

/// The progress of a run as a line: "square: 12.3 of 30.0 s". @param run  key "run" of a status
std::string ProgressText(const Reply& run);

}  // namespace flexarm
