// The record file: what a run is while it is written, and what is left of one that was killed.

#include <sys/stat.h>

#include <chrono>

#include "controller/runlog/blob.h"
#include "controller/runlog/checksum.h"
#include "controller/runlog/run_recovery.h"
#include "tests/controller/runlog/runlog_fixture.h"

namespace flexarm {
namespace {

class RecordFileTest : public RunLogTest {
 protected:
  // The bytes of a run of `ticks` ticks whose program was killed before it ended the run, and where
  // its last record begins.
  std::string LeftBytes(int ticks, std::size_t* last_record = nullptr) {
    RunWriter writer(File("whole"), MakeInfo());
    writer.Safety(MakeSafety(1, kIdleStatus, RequestKind::kArm));
    for (int tick = 1; tick < ticks; ++tick) {
      writer.Tick(MakeTick(tick));
      writer.Commit();
    }
    if (last_record != nullptr) *last_record = Bytes(File("whole")).size();
    writer.Tick(MakeTick(ticks));
    writer.Commit();
    std::string bytes = Bytes(File("whole"));
    std::filesystem::remove(File("whole"));
    return bytes;
  }
  static bool IsPrefix(const RunContents& run) {
    for (std::size_t n = 0; n < run.tick.size(); ++n) {
      const TickRecord expected = MakeTick(static_cast<int>(n) + 1);
      if (!SameBytes(run.tick[n].input, expected.input)) return false;
      if (!SameBytes(run.tick[n].output, expected.output)) return false;
      if (run.tick[n].truth.tip_m != expected.truth.tip_m) return false;
    }
    return true;
  }
};

TEST_F(RecordFileTest, EveryKindOfRecordReadsBackBeforeTheRunEnds) {
  const SafetyRecord safety = MakeSafety(5, kIdleStatus, RequestKind::kArm);
  TickRecord odd = MakeTick(3);
  odd.output.torque_nm = {-0.0, std::numeric_limits<double>::quiet_NaN()};
  odd.gate_reasons = 0b10010;
  odd.truth.known = false;
  RunInfo info = MakeInfo();
  info.experiment_name = "square";
  info.experiment_text = "text one";
  RunWriter writer(File(), info);
  writer.Safety(safety);
  writer.Tick(MakeTick(2));
  writer.Tick(odd);
  writer.Timing({.tick = 1, .due_ns = 2, .woke_ns = 3, .finished_ns = 4});
  writer.Event({.time_ns = 7,
                .kind = "gap",
                .name = "ticks",
                .text = "it's \"so\"",
                .value_json = "{\"a\":1}"});
  writer.Commit();
  RunReader reader(File());
  EXPECT_EQ(reader.state(), RunState::kWritten);
  EXPECT_EQ(reader.left_out_bytes(), 0U);
  const RunContents run = reader.ReadAll();
  EXPECT_EQ(run.info.seed, MakeInfo().seed);
  EXPECT_EQ(run.info.config_text, MakeInfo().config_text);
  EXPECT_EQ(run.info.experiment_name, "square");
  EXPECT_EQ(run.info.experiment_text, "text one");
  EXPECT_EQ(run.info.result_json, "");
  ASSERT_EQ(run.tick.size(), 2U);
  EXPECT_TRUE(SameBytes(run.tick[0].input, MakeTick(2).input));
  EXPECT_TRUE(SameBytes(run.tick[1].output, odd.output));
  EXPECT_EQ(run.tick[0].truth.hub_angle_rad, MakeTick(2).truth.hub_angle_rad);
  EXPECT_FALSE(run.tick[1].truth.known);
  EXPECT_EQ(run.tick[1].gate_reasons, 0b10010U);
  ASSERT_EQ(run.safety.size(), 1U);
  EXPECT_TRUE(SameBytes(run.safety[0], safety));
  ASSERT_EQ(run.timing.size(), 1U);
  EXPECT_EQ(run.timing[0].finished_ns, 4);
  ASSERT_EQ(run.event.size(), 1U);
  EXPECT_EQ(run.event[0].text, "it's \"so\"");
}

TEST_F(RecordFileTest, ARunThatIsTornAtAnyByteOfItsLastRecordIsTheRunBeforeIt) {
  std::size_t last_record = 0;
  const std::string whole = LeftBytes(3, &last_record);
  ASSERT_GT(whole.size(), last_record + 300);
  for (std::size_t length = last_record; length < whole.size(); ++length) {
    WriteText(File(), whole.substr(0, length));
    RunReader reader(File());
    const RunContents run = reader.ReadAll();
    ASSERT_EQ(run.tick.size(), 2U) << length;
    ASSERT_TRUE(IsPrefix(run));
    ASSERT_EQ(reader.left_out_bytes(), length - last_record);
    ASSERT_EQ(reader.state(), RunState::kLeft);
  }
  WriteText(File(), whole);
  EXPECT_EQ(RunReader(File()).ReadAll().tick.size(), 3U);
}

TEST_F(RecordFileTest, NoFlippedBitChangesWhatIsRead) {
  std::size_t last_record = 0;
  const std::string whole = LeftBytes(5, &last_record);
  std::mt19937 random(14);
  int torn = 0, damaged = 0;
  for (int i = 0; i < 400; ++i) {
    const std::size_t at = random() % whole.size();
    std::string flipped = whole;
    flipped[at] = static_cast<char>(flipped[at] ^ (1 << random() % 8));
    WriteText(File(), flipped);
    try {
      RunReader reader(File());
      ASSERT_GE(at, last_record) << "a flipped bit in the middle was not told";
      ASSERT_EQ(reader.left_out_bytes(), whole.size() - last_record);
      ASSERT_EQ(reader.ReadAll().tick.size(), 4U);
      ++torn;
    } catch (const InputError& error) {
      ASSERT_LT(at, last_record) << error.what();
      ++damaged;
    }
  }
  EXPECT_GT(torn, 30);
  EXPECT_GT(damaged, 200);
}

TEST_F(RecordFileTest, DamageInTheMiddleIsNamedWithItsByteAndThePartBeforeIsRecovered) {
  const std::string whole = LeftBytes(5);
  std::string damaged = whole;
  damaged[whole.size() / 2] ^= 1;
  WriteText(File(), damaged);
  const std::string error = ReadingError(File());
  EXPECT_NE(error.find("damaged at byte "), std::string::npos) << error;
  EXPECT_NE(error.find("flexarm log recover"), std::string::npos) << error;

  const Recovery recovery = RecoverRun(File());
  EXPECT_EQ(recovery.result, Recovery::Result::kRecovered) << recovery.text;
  EXPECT_NE(recovery.text.find("damage at byte"), std::string::npos) << recovery.text;
  RunReader reader(File());
  const RunContents run = reader.ReadAll();
  EXPECT_TRUE(reader.closed());
  EXPECT_FALSE(run.tick.empty());
  EXPECT_LT(run.tick.size(), 5U);
  EXPECT_TRUE(IsPrefix(run));
  EXPECT_EQ(Bytes(File("run.flexarm.damaged")), damaged);
}

// The checksum of a record holds at its own place only.
TEST_F(RecordFileTest, ARecordInAnotherPlaceIsNoneOfTheRun) {
  std::size_t last_record = 0;
  const std::string whole = LeftBytes(3, &last_record);
  const std::string record = whole.substr(last_record);
  WriteText(File(), whole + record);
  RunReader reader(File());
  EXPECT_EQ(reader.ReadAll().tick.size(), 3U);
  EXPECT_EQ(reader.left_out_bytes(), record.size());
}

TEST_F(RecordFileTest, ABlankRecordFileIsARunWithoutTicks) {
  WriteText(File(), LeftBytes(1).substr(0, kRecordHeaderBytes));
  EXPECT_EQ(RunReader(File()).ReadAll().tick.size(), 0U);
}

TEST_F(RecordFileTest, ARecordFileOfAnotherVersionIsToldAndLeftAlone) {
  std::string bytes = LeftBytes(2);
  for (const std::size_t at : {8U, 12U, 16U, 20U}) {
    std::string other = bytes;
    other[at] = 99;
    const std::uint64_t checksum = Checksum64(std::string_view(other).substr(0, 24), 0);
    std::memcpy(other.data() + 24, &checksum, sizeof checksum);
    WriteText(File(), other);
    const std::string error = ReadingError(File());
    EXPECT_NE(error.find("another version of flexarm"), std::string::npos) << error;
    EXPECT_EQ(RecoverRun(File()).result, Recovery::Result::kFailed);
    EXPECT_EQ(Bytes(File()), other);
  }
  bytes[9] ^= 1;
  WriteText(File(), bytes);
  EXPECT_NE(ReadingError(File()).find("damaged in its header"), std::string::npos);
}

// A file full of beginnings of long records costs no more than one look at each.
TEST_F(RecordFileTest, AFileMadeToHurtIsReadQuickly) {
  std::string bytes = LeftBytes(1).substr(0, kRecordHeaderBytes);
  const std::uint32_t length = kLargestPayload;
  std::string beginning = "TICK";
  beginning.append(reinterpret_cast<const char*>(&length), sizeof length);
  while (bytes.size() < kLargestPayload + (1 << 20)) bytes += beginning;
  WriteText(File(), bytes);
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(RunReader(File()).ReadAll().tick.size(), 0U);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(20));
}

TEST_F(RecordFileTest, AFifoIsRefusedByName) {
  ASSERT_EQ(::mkfifo(File().c_str(), 0600), 0);
  EXPECT_NE(ReadingError(File()).find("is a FIFO"), std::string::npos);
  EXPECT_EQ(RecoverRun(File()).result, Recovery::Result::kFailed);
}

}  // namespace
}  // namespace flexarm
