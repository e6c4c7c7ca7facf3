#pragma once

#include "tools/command_line/verbs.h"

namespace flexarm {

/// Adds verbs to the program; they set `exit.code` when they run.
using RegisterVerbs = void(CLI::App& app, Exit& exit);

/// Runs the verb that the arguments name: the main function of flexarm, flexarm-study and
/// flexarm-web, which differ in their verbs. Prints errors to stderr. Returns the exit code of the
/// process.
/// @param name  of the program's file: "flexarm"
int RunProgram(const char* name, int argc, char** argv, RegisterVerbs* register_verbs) noexcept;

}  // namespace flexarm
