#include "tools/command_line/program.h"
#include "tools/command_line/verbs.h"

namespace flexarm {
namespace {

void RegisterStudies(CLI::App& app, Exit& exit) {
  RegisterModes(app, exit);
  RegisterAnalyze(app, exit);
  RegisterBound(app, exit);
  RegisterSweep(app, exit);
  RegisterTorture(app, exit);
  RegisterBenchmark(app, exit);
  RegisterReport(app, exit);
  RegisterBenchHost(app, exit);
  RegisterGauges(app, exit);
  RegisterIdentify(app, exit);
  RegisterExport(app, exit);
}

}  // namespace
}  // namespace flexarm

int main(int argc, char** argv) {
  return flexarm::RunProgram("flexarm-study", argc, argv, flexarm::RegisterStudies);
}
