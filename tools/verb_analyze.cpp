#include <CLI/CLI.hpp>

#include "tools/studies.h"
#include "tools/verbs.h"

namespace flexarm {

void RegisterAnalyze(CLI::App& app, Exit& exit) {
  CLI::App* verb = AddStudy(app, "analyze");
  verb->require_subcommand(1);
  RegisterAnalyzeCheck(*verb, exit);
  RegisterAnalyzeExcite(*verb, exit);
  RegisterAnalyzeLinearize(*verb, exit);
  RegisterAnalyzeParametric(*verb, exit);
  RegisterAnalyzeReduce(*verb, exit);
}

}  // namespace flexarm
