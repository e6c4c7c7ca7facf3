#include "tools/program.h"
#include "tools/verbs.h"

namespace flexarm {
namespace {

void RegisterStudies(CLI::App& app, Exit& exit) {
  RegisterModes(app, exit);
  RegisterAnalyze(app, exit);
  RegisterSweep(app, exit);
  RegisterBenchmark(app, exit);
  RegisterReport(app, exit);
  RegisterIdentify(app, exit);
}

}  // namespace
}  // namespace flexarm

int main(int argc, char** argv) {
  return flexarm::RunProgram(argc, argv, flexarm::RegisterStudies);
}
