#include "tools/command_line/studies.h"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <stdexcept>
#include <string>

#include "tools/command_line/verbs.h"

namespace flexarm {
namespace {

const Study* Find(std::string_view verb) noexcept {
  for (const Study& study : kStudies) {
    if (study.verb == verb) return &study;
  }
  return nullptr;
}

}  // namespace

bool IsStudy(std::string_view verb) noexcept { return Find(verb) != nullptr; }

CLI::App* AddStudy(CLI::App& app, std::string_view verb) {
  const Study* study = Find(verb);
  if (study == nullptr) throw std::out_of_range("no study is called " + std::string(verb));
  return app.add_subcommand(std::string(study->verb), std::string(study->description));
}

int BecomeStudyProgram(char** argv) {
  const std::filesystem::path program =
      std::filesystem::read_symlink("/proc/self/exe").replace_filename("flexarm-study");
  execv(program.c_str(), argv);
  std::cerr << "flexarm: " << program.string() << ", which has the verb \"" << argv[1]
            << "\": " << std::strerror(errno)
            << "\nBuild it: cmake --build --preset release --target flexarm-study\n";
  return Exit::kFailed;
}

}  // namespace flexarm
