#pragma once

#include <filesystem>
#include <string>

namespace CLI {
class App;
}

namespace flexarm {

/// A page of the manual, written from the texts of --help.
struct ManualTitle {
  std::string command;  ///< "flexarm config"; the page is flexarm-config.1
  int section;          ///< 1: a program of users, 8: of administrators
  std::string version;  ///< "0.1.0"
};

/// The page in the language of man(7), for the verb or program `app` with all verbs below it.
std::string ManualPage(const CLI::App& app, const ManualTitle& title);

/// Writes the page of a program and one of each of its verbs into FOLDER/manN. A verb that another
/// program has (other_programs.h) is left to that one.
/// @param name  of the program: "flexarm"
/// @throws std::exception if a file cannot be written
void WriteManual(const CLI::App& program, const ManualTitle& title,
                 const std::filesystem::path& folder);

}  // namespace flexarm
