#include "tools/bench_host/wake_up_row.h"

#include <gtest/gtest.h>
#include <signal.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "config/config.h"
#include "tools/support/scratch_folder.h"

namespace flexarm {
namespace {

// What cyclictest 2.5 prints with --quiet --histogram=4.
constexpr const char* kHistogram =
    "# /dev/cpu_dma_latency set to 0us\n"
    "# Histogram\n"
    "000000 000000\n"
    "000001 000000\n"
    "000002 000003\n"
    "000003 000001\n"
    "# Total: 000000004\n"
    "# Min Latencies: 00002\n"
    "# Avg Latencies: 00009\n";

TEST(Cyclictest, TheHistogramIsReadAsOneLatenessForEachWakeUp) {
  const std::string none = std::string(kHistogram) +
                           "# Max Latencies: 00003\n"
                           "# Histogram Overflows: 00000\n"
                           "# Histogram Overflow at cycle number:\n"
                           "# Thread 0:\n";
  EXPECT_EQ(ParseCyclictest(none), (std::vector<double>{2.0, 2.0, 2.0, 3.0}));
}

TEST(Cyclictest, WakeUpsBeyondTheHistogramAreNotLost) {
  const std::string two = std::string(kHistogram) +
                          "# Max Latencies: 00040\n"
                          "# Histogram Overflows: 00002\n"
                          "# Histogram Overflow at cycle number:\n"
                          "# Thread 0: 00003 00005\n";
  EXPECT_EQ(ParseCyclictest(two), (std::vector<double>{2.0, 2.0, 2.0, 3.0, 4.0, 40.0}));
}

TEST(Cyclictest, WhatIsNoHistogramIsRefused) {
  EXPECT_THROW(ParseCyclictest(""), std::runtime_error);
  EXPECT_THROW(ParseCyclictest(kHistogram), std::runtime_error);
  EXPECT_THROW(ParseCyclictest("# Max Latencies: x\n# Histogram Overflows: 00000\n"),
               std::runtime_error);
  EXPECT_THROW(ParseCyclictest("# Max Latencies: 00000\n# Histogram Overflows: 00000\n"),
               std::runtime_error);
}

// PATH begins with this folder while the object lives, or is nothing else.
class ProgramFolder {
 public:
  explicit ProgramFolder(bool alone) : before_(std::getenv("PATH")) {
    const std::string own = scratch_.path().string();
    ::setenv("PATH", (alone ? own : own + ":" + before_).c_str(), 1);
  }
  ~ProgramFolder() { ::setenv("PATH", before_.c_str(), 1); }
  ProgramFolder(const ProgramFolder&) = delete;
  ProgramFolder& operator=(const ProgramFolder&) = delete;

  void Add(const std::string& name, const std::string& script) {
    std::ofstream(path() / name) << "#!/bin/sh\n" << script << '\n';
    std::filesystem::permissions(path() / name, std::filesystem::perms::owner_all);
  }
  const std::filesystem::path& path() const { return scratch_.path(); }

 private:
  std::string before_;
  ScratchFolder scratch_;
};

BenchSetting SettingWith(const std::filesystem::path& programs) {
  return {.config_file = {},
          .config = LoadConfig(FLEXARM_SOURCE_DIR "/config/hil.toml"),
          .experiment = {},
          .programs = programs,
          .quick = true};
}

TEST(WakeUpRow, SaysWhichProgramIsMissing) {
  const ScratchFolder scratch;
  ProgramFolder programs(true);
  const BenchSetting setting = SettingWith(programs.path());
  EXPECT_NE(LoadedWakeUpRow(setting, scratch.path()).not_measured.find("no cyclictest in PATH"),
            std::string::npos);
  programs.Add("cyclictest", "exit 0");
  programs.Add("flexarmd", "echo refused >&2; exit 3");
  EXPECT_NE(LoadedWakeUpRow(setting, scratch.path()).not_measured.find("no stress-ng in PATH"),
            std::string::npos);
  EXPECT_NE(WakeUpRow(setting, scratch.path()).not_measured.find("flexarmd: refused"),
            std::string::npos);
}

// The daemon waits until the load runs, and then fails.
TEST(WakeUpRow, TheLoadIsStoppedIfTheDaemonFails) {
  const ScratchFolder scratch;
  ProgramFolder programs(false);
  const std::string number = (programs.path() / "number").string();
  programs.Add("cyclictest", "exit 0");
  programs.Add("stress-ng", "echo $$ >" + number + ".new && mv " + number + ".new " + number +
                                " && exec sleep 1000");
  programs.Add("flexarmd", "while [ ! -e " + number + " ]; do sleep 0.01; done; " +
                               "kill -0 $(cat " + number + ") && echo refused >&2; exit 3");
  const BenchRow row = LoadedWakeUpRow(SettingWith(programs.path()), scratch.path());
  EXPECT_EQ(row.name, "wake-up-under-load");
  EXPECT_NE(row.not_measured.find("flexarmd: refused"), std::string::npos) << row.not_measured;
  pid_t load = 0;
  std::ifstream(number) >> load;
  ASSERT_NE(load, 0);
  EXPECT_EQ(::kill(load, 0), -1);
  EXPECT_EQ(errno, ESRCH);
}

}  // namespace
}  // namespace flexarm
