#include "tools/command_line/self_description.h"

#include <CLI/CLI.hpp>
#include <iostream>
#include <string_view>
#include <vector>

#include "controller/runlog/build_info.h"
#include "tools/command_line/completion.h"
#include "tools/command_line/manual_page.h"
#include "tools/command_line/verbs.h"

namespace flexarm {

std::optional<int> DescribeItself(const CLI::App& program, const std::string& name, int section,
                                  int argc, char** argv) {
  const std::string_view first = argc > 1 ? argv[1] : "";
  if (first == kCompleteOption) {
    const std::vector<std::string> words(argv + 2, argv + argc);
    std::cout << CompletionText(Complete(program, words));
    return Exit::kDone;
  }
  if (first == kWriteManualOption && argc == 3) {
    WriteManual(program, {.command = name, .section = section, .version = ThisBuild().version},
                argv[2]);
    return Exit::kDone;
  }
  return std::nullopt;
}

}  // namespace flexarm
