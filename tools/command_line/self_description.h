#pragma once

#include <optional>
#include <string>

namespace CLI {
class App;
}

namespace flexarm {

/// First arguments with which a program describes itself and does nothing else. They are for
/// scripts, and --help does not show them.
inline constexpr const char* kCompleteOption = "--complete";         ///< WORD.. (completion.h)
inline constexpr const char* kWriteManualOption = "--write-manual";  ///< FOLDER (manual_page.h)

/// Answers such an argument.
/// @param name     of the program: "flexarm"
/// @param section  of its page of the manual
/// @returns the exit code; nothing: the command line has no such argument
/// @throws std::exception if a page cannot be written
std::optional<int> DescribeItself(const CLI::App& program, const std::string& name, int section,
                                  int argc, char** argv);

}  // namespace flexarm
