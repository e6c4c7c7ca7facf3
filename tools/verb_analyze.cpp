#include <CLI/CLI.hpp>

#include "tools/verbs.h"

namespace flexarm {

void RegisterAnalyze(CLI::App& app, Exit& exit) {
  CLI::App* verb = app.add_subcommand("analyze", "What the model says about the arm");
  verb->require_subcommand(1);
  RegisterAnalyzeCheck(*verb, exit);
  RegisterAnalyzeExcite(*verb, exit);
  RegisterAnalyzeLinearize(*verb, exit);
  RegisterAnalyzeParametric(*verb, exit);
  RegisterAnalyzeReduce(*verb, exit);
}

}  // namespace flexarm
