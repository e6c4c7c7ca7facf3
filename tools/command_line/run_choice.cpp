#include "tools/command_line/run_choice.h"

#include <CLI/CLI.hpp>

#include "controller/files/input_error.h"
#include "controller/runlog/run_list.h"

namespace flexarm {

void AddRunFolder(CLI::App* verb, std::filesystem::path* folder) {
  verb->add_option("--folder", *folder, "Folder of the run logs, log.directory of the config")
      ->type_name("DIR")
      ->capture_default_str();
}

void RunChoice::AddTo(CLI::App* verb, const char* what, const char* type) {
  verb->add_option("run", files_, what)->type_name(type)->expected(1);
  AddLast(verb);
}

void RunChoice::AddManyTo(CLI::App* verb) {
  verb->add_option("runs", files_, "Run logs")->type_name("RUN..");
  AddLast(verb);
}

void RunChoice::AddOptionTo(CLI::App* verb, const std::string& name, const std::string& what) {
  verb->add_option(name, files_, what)->type_name("RUN")->expected(1);
  verb->add_flag("--last", last_, "The same with the newest run of the folder");
  AddRunFolder(verb, &folder_);
}

void RunChoice::AddLast(CLI::App* verb) {
  verb->add_flag("--last", last_, "The newest run of the folder");
  AddRunFolder(verb, &folder_);
}

std::vector<std::filesystem::path> RunChoice::Files() const {
  if (last_ == files_.empty()) {
    if (last_) return {NewestRun(folder_)};
    return files_;
  }
  throw InputError(last_ ? "--last and a run: expected one of both"
                         : "no run: expected a run log, or --last for the newest of --folder");
}

}  // namespace flexarm
