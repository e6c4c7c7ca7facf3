#include "tools/command_line/label_options.h"

#include <CLI/CLI.hpp>

#include "controller/files/input_error.h"
#include "controller/runlog/run_label.h"

namespace flexarm {

void LabelOptions::AddTo(CLI::App* verb) {
  verb->add_option("--name", label_.name, "Name of the run, for its log")->type_name("TEXT");
  verb->add_option("--note", label_.note, "Note on the run, one line")->type_name("TEXT");
  verb->add_option("--tag", label_.tags, "Word by which `flexarm runs` finds it; repeatable")
      ->type_name("WORD")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

RunLabel LabelOptions::Label() const {
  const std::string problem = ProblemOfLabel(label_);
  if (problem.empty()) return label_;
  throw InputError("--name, --note, --tag: " + problem +
                   "; expected one line of text each, of at most " + std::to_string(kLongestName) +
                   ", " + std::to_string(kLongestNote) + " and " + std::to_string(kLongestTag) +
                   " bytes");
}

}  // namespace flexarm
