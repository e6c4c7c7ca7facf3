#include "tools/command_line/program.h"
#include "tools/command_line/verbs.h"

int main(int argc, char** argv) {
  return flexarm::RunProgram("flexarm-web", argc, argv, flexarm::RegisterDashboard);
}
