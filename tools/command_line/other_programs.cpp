#include "tools/command_line/other_programs.h"

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

const OtherVerb* Find(std::string_view verb) noexcept {
  for (const OtherVerb& other : kOtherVerbs) {
    if (other.verb == verb) return &other;
  }
  return nullptr;
}

}  // namespace

bool IsOtherVerb(std::string_view verb) noexcept { return Find(verb) != nullptr; }

std::string_view ProgramOf(std::string_view verb) noexcept {
  const OtherVerb* other = Find(verb);
  return other != nullptr ? other->program : "flexarm";
}

const OtherVerb& RowOf(std::string_view verb) {
  const OtherVerb* other = Find(verb);
  if (other == nullptr) throw std::out_of_range("no other verb is called " + std::string(verb));
  return *other;
}

CLI::App* AddOtherVerb(CLI::App& app, std::string_view verb) {
  const OtherVerb& other = RowOf(verb);
  return app.add_subcommand(std::string(other.verb), std::string(other.description));
}

int BecomeOtherProgram(std::string_view verb, char** argv) {
  const std::string_view name = ProgramOf(verb);
  const std::filesystem::path program =
      std::filesystem::read_symlink("/proc/self/exe").replace_filename(name);
  execv(program.c_str(), argv);
  std::cerr << "flexarm: " << program.string() << ", which has the verb \"" << verb
            << "\": " << std::strerror(errno)
            << "\nBuild it: cmake --build --preset release --target " << name << '\n';
  return Exit::kFailed;
}

}  // namespace flexarm
