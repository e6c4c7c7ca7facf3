#include <CLI/CLI.hpp>

#include "tools/command_line/other_programs.h"
#include "tools/command_line/verbs.h"

namespace flexarm {

void RegisterAnalyze(CLI::App& app, Exit& exit) {
  CLI::App* verb = AddOtherVerb(app, "analyze");
  verb->require_subcommand(1);
  RegisterAnalyzeCheck(*verb, exit);
  RegisterAnalyzeExcite(*verb, exit);
  RegisterAnalyzeLinearize(*verb, exit);
  RegisterAnalyzeParametric(*verb, exit);
  RegisterAnalyzeReduce(*verb, exit);
  RegisterAnalyzeTorsion(*verb, exit);
}

}  // namespace flexarm
