#include "tools/command_line/program.h"
#include "tools/command_line/studies.h"
#include "tools/command_line/verbs.h"

namespace flexarm {
namespace {

// The order of --help: design and analyse, simulate and evaluate, operate.
void RegisterOwnVerbs(CLI::App& app, Exit& exit) {
  RegisterConfig(app, exit);
  AddStudy(app, "modes");
  AddStudy(app, "analyze");
  RegisterDesign(app, exit);
  RegisterSimulate(app, exit);
  AddStudy(app, "sweep");
  AddStudy(app, "benchmark");
  AddStudy(app, "report");
  RegisterReplay(app, exit);
  AddStudy(app, "gauges");
  AddStudy(app, "identify");
  RegisterInfo(app, exit);
  RegisterPlot(app, exit);
  RegisterExport(app, exit);
  RegisterCheck(app, exit);
  RegisterCheckHost(app, exit);
  RegisterDiff(app, exit);
  RegisterLog(app, exit);
  RegisterRuns(app, exit);
  RegisterOperate(app, exit);
  RegisterCommission(app, exit);
  RegisterProveSwitches(app, exit);
  RegisterRig(app, exit);
  RegisterLinesOff(app, exit);
}

}  // namespace
}  // namespace flexarm

int main(int argc, char** argv) {
  if (argc > 1 && flexarm::IsStudy(argv[1])) return flexarm::BecomeStudyProgram(argv);
  return flexarm::RunProgram(argc, argv, flexarm::RegisterOwnVerbs);
}
