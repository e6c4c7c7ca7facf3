#include <string_view>

#include "tools/command_line/other_programs.h"
#include "tools/command_line/program.h"
#include "tools/command_line/self_description.h"
#include "tools/command_line/verbs.h"

namespace flexarm {
namespace {

// The order of --help: design and analyse, simulate and evaluate, operate.
void RegisterOwnVerbs(CLI::App& app, Exit& exit) {
  RegisterConfig(app, exit);
  AddOtherVerb(app, "modes");
  AddOtherVerb(app, "analyze");
  RegisterDesign(app, exit);
  RegisterSimulate(app, exit);
  AddOtherVerb(app, "bound");
  AddOtherVerb(app, "sweep");
  AddOtherVerb(app, "benchmark");
  AddOtherVerb(app, "report");
  AddOtherVerb(app, "torture");
  AddOtherVerb(app, "bench-host");
  RegisterReplay(app, exit);
  AddOtherVerb(app, "gauges");
  AddOtherVerb(app, "identify");
  RegisterInfo(app, exit);
  RegisterPlot(app, exit);
  AddOtherVerb(app, "export");
  RegisterCheck(app, exit);
  RegisterCheckHost(app, exit);
  RegisterDiff(app, exit);
  RegisterLog(app, exit);
  RegisterRuns(app, exit);
  RegisterHealth(app, exit);
  RegisterOperate(app, exit);
  AddOtherVerb(app, "dashboard");
  RegisterCommission(app, exit);
  RegisterProveSwitches(app, exit);
  RegisterExplain(app, exit);
  RegisterTripReport(app, exit);
  RegisterRig(app, exit);
  RegisterLinesOff(app, exit);
}

}  // namespace
}  // namespace flexarm

int main(int argc, char** argv) {
  // The verb: the first argument, or the first whole word of a command line to be completed.
  const bool completes = argc > 3 && std::string_view(argv[1]) == flexarm::kCompleteOption;
  const char* verb = completes ? argv[2] : argc > 1 ? argv[1] : "";
  if (flexarm::IsOtherVerb(verb)) return flexarm::BecomeOtherProgram(verb, argv);
  return flexarm::RunProgram("flexarm", argc, argv, flexarm::RegisterOwnVerbs);
}
