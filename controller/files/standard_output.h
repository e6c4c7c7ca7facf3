#pragma once

#include <string>

namespace flexarm {

/// Writes out what std::cout and stdout hold. Returns what was lost and why: "standard output
/// cannot be written: No space left on device"; empty if all was written.
/// Thread: the main one, at the end of the program.
std::string FlushStandardOutput();

}  // namespace flexarm
