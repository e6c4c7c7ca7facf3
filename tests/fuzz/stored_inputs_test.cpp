// The inputs that are stored beside the targets of fuzzing: corpus/TARGET is where fuzzing begins,
// found/TARGET what once ended a program, with a name that says how.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <string>
#include <vector>

#include "tests/fuzz/fuzz_targets.h"

namespace flexarm {
namespace {

struct Target {
  const char* name;
  void (*run)(FuzzBytes);
};

std::ostream& operator<<(std::ostream& out, const Target& target) { return out << target.name; }

class StoredInputs : public testing::TestWithParam<Target> {
 protected:
  // Runs every file; the number of them. A file is named before it runs: it may end the process.
  static int RunFolder(const std::string& kind) {
    const std::filesystem::path folder =
        std::filesystem::path(FLEXARM_SOURCE_DIR "/tests/fuzz") / kind / GetParam().name;
    int files = 0;
    if (!std::filesystem::exists(folder)) return 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      std::cout << entry.path().string() << std::endl;
      std::ifstream file(entry.path(), std::ios::binary);
      const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file), {}};
      GetParam().run(bytes);
      ++files;
    }
    return files;
  }
};

TEST_P(StoredInputs, NoneOfTheCorpusEndsTheProgram) { EXPECT_GT(RunFolder("corpus"), 0); }

TEST_P(StoredInputs, WhatOnceEndedItDoesSoNoMore) { RunFolder("found"); }

TEST_P(StoredInputs, AnEmptyInputIsAnInput) { GetParam().run({}); }

INSTANTIATE_TEST_SUITE_P(Fuzz, StoredInputs,
                         testing::Values(Target{"calibration", FuzzCalibration},
                                         Target{"can", FuzzCan}, Target{"client", FuzzClient},
                                         Target{"comedi", FuzzComedi}, Target{"config", FuzzConfig},
                                         Target{"csv", FuzzCsv},
                                         Target{"experiment", FuzzExperiment},
                                         Target{"gains", FuzzGains}, Target{"log", FuzzLog},
                                         Target{"modbus", FuzzModbus}, Target{"socket", FuzzSocket},
                                         Target{"telemetry", FuzzTelemetry}),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace flexarm
