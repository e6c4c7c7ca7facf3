#include "tools/bench_host/machine_notes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace flexarm {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

MachineNotes Quiet() {
  return {.processor = "X",
          .cores = 2,
          .is_virtual = false,
          .kernel = "Linux 6",
          .governor = "",
          .load = 0.05,
          .processor_share = 1.0,
          .compiler = "GNU 12",
          .build_type = "Release",
          .build = "abc"};
}

TEST(MachineNotes, AQuietMachineHasNoWarning) { EXPECT_THAT(WarningsOf(Quiet()), ElementsAre()); }

TEST(MachineNotes, WarnOfABusyMachine) {
  MachineNotes busy = Quiet();
  busy.load = 1.5;
  EXPECT_THAT(WarningsOf(busy), ElementsAre(HasSubstr("load 1.5")));
  busy = Quiet();
  busy.processor_share = 0.5;
  EXPECT_THAT(WarningsOf(busy), ElementsAre(HasSubstr("50 %")));
}

TEST(MachineNotes, WarnOfTheGovernorAndTheBuild) {
  MachineNotes machine = Quiet();
  machine.governor = "powersave";
  machine.build_type = "Debug";
  EXPECT_THAT(WarningsOf(machine), ElementsAre(HasSubstr("powersave"), HasSubstr("Debug")));
  machine.governor = "performance";
  EXPECT_THAT(WarningsOf(machine), ElementsAre(HasSubstr("Debug")));
}

TEST(MachineNotes, ReadThisMachine) {
  const MachineNotes machine = ReadMachine(HostFiles());
  EXPECT_FALSE(machine.processor.empty());
  EXPECT_GE(machine.cores, 1);
  EXPECT_GT(machine.processor_share, 0.0);
  EXPECT_LE(machine.processor_share, 1.0);
  EXPECT_FALSE(machine.build.empty());
}

TEST(MachineNotes, WithoutFilesOfTheKernelTheProcessorIsUnknown) {
  EXPECT_EQ(ReadMachine(HostFiles("/nowhere")).processor, "unknown");
}

}  // namespace
}  // namespace flexarm
