// What a sample takes in a log: an hour at 50 Hz is at most 100 MB, at other rates in proportion.

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "config/config.h"
#include "controller/design/design_json.h"
#include "controller/host/simulation.h"
#include "controller/runlog/blob.h"
#include "controller/runlog/replay.h"
#include "controller/runlog/run_reader.h"
#include "controller/runlog/run_writer.h"
#include "controller/step/control_step.h"

namespace flexarm {
namespace {

constexpr double kMostBytes = 100e6 / (3600 * 50);  // of a sample, 555.6

// Blocks of a quarter of a second pack less well. Measured: 250 to 519, receding-horizon.
constexpr double kMostBytesWhileRecorded = 560;

struct Case {
  const char* rig;
  const char* law;
};

void PrintTo(const Case& value, std::ostream* out) { *out << value.rig << ", " << value.law; }

// Back and forth between other angles each time, with rests between.
Experiment Moves(int moves) {
  std::string text = "name = \"moves\"\nduration_s = " + std::to_string(3 * moves) + ".0\n";
  for (int i = 0; i < moves; ++i) {
    text += "[[move]]\nstart_s = " + std::to_string(3 * i) + ".3\nduration_s = 2.0\nto_deg = [" +
            std::to_string((i * 7) % 41 - 20) + ".5, " + std::to_string((i * 11) % 61 - 30) +
            ".25]\n";
  }
  return ParseExperiment(text, "moves");
}

class LogSize : public ::testing::TestWithParam<Case> {
 protected:
  void SetUp() override {
    std::string pattern = (std::filesystem::temp_directory_path() / "log-size-XXXXXX").string();
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path Recorded(int moves) const {
    const std::filesystem::path file = folder_ / (std::to_string(moves) + ".flexarm");
    const std::string rig = std::string(FLEXARM_SOURCE_DIR "/config/") + GetParam().rig;
    const RigConfig config =
        LoadConfig(rig, {std::string("controller.name=") + GetParam().law, "sim.seed=5"});
    EXPECT_TRUE(
        Simulate({.config = config, .experiment = Moves(moves), .payload_kg = {}, .log = file})
            .completed);
    return file;
  }

  // The same records, as while they were recorded: a commit every quarter of a second.
  std::filesystem::path WhileRecorded(const RunContents& run, double period_s) const {
    const std::filesystem::path file = folder_ / "recorded", copy = folder_ / "copy";
    RunWriter writer(file, run.info);
    int ticks = 0;
    for (const TickRecord& tick : run.tick) {
      writer.Tick(tick);
      if (++ticks % static_cast<int>(0.25 / period_s) == 0) writer.Commit();
    }
    writer.Commit();
    std::filesystem::copy(file, copy);
    return copy;
  }

  std::filesystem::path folder_;
};

double Bytes(const std::filesystem::path& file) {
  return static_cast<double>(std::filesystem::file_size(file));
}

// The texts of a log, config and gains, are in both files of a difference.
TEST_P(LogSize, AnHourTakesAtMostItsShareAndEveryBitOfItComesBack) {
  const std::filesystem::path shorter = Recorded(30), longer = Recorded(90);
  const RunContents short_run = RunReader(shorter).ReadAll(), run = RunReader(longer).ReadAll();
  const double samples = static_cast<double>(run.tick.size() - short_run.tick.size());
  EXPECT_LE((Bytes(longer) - Bytes(shorter)) / samples, kMostBytes);

  const double period_s =
      static_cast<double>(run.tick[1].input.now_ns - run.tick[0].input.now_ns) * 1e-9;
  const std::filesystem::path recorded = WhileRecorded(run, period_s);
  const double texts =
      static_cast<double>(run.info.config_text.size() + run.info.gains_json.size());
  EXPECT_LE((Bytes(recorded) - texts) / static_cast<double>(run.tick.size()),
            kMostBytesWhileRecorded);

  const RigConfig config = ParseConfig(run.info.config_text, "log");
  ControlStep step(config, DesignFromJson(run.info.gains_json, config));
  Replay replay([&step](const StepInput& input) { return step.Step(input); }, false);
  RunReader copy(recorded);
  std::size_t n = 0;
  copy.ForEachTick([&](const TickRecord& tick) {
    ASSERT_TRUE(SameBytes(tick.input, run.tick.at(n).input)) << "tick " << tick.input.tick;
    ASSERT_TRUE(SameBytes(tick.output, run.tick.at(n).output)) << "tick " << tick.input.tick;
    ASSERT_EQ(tick.output_checksum, run.tick.at(n).output_checksum);
    replay.Tick(tick);
    ++n;
  });
  EXPECT_EQ(n, run.tick.size());
  EXPECT_EQ(replay.Result().bit_exact, true);
}

INSTANTIATE_TEST_SUITE_P(
    RigsAndLaws, LogSize,
    ::testing::Values(Case{"hil.toml", "sobel"}, Case{"hil.toml", "gain-scheduled"},
                      Case{"hil.toml", "receding-horizon"}, Case{"hil.toml", "pd"},
                      Case{"half-bridges.toml", "gain-scheduled"}, Case{"daq-rig.toml", "lqg"},
                      Case{"quanser-2dsfl.toml", "sobel"}));

}  // namespace
}  // namespace flexarm
