// Replay detects the smallest difference, in the loop and in the safety state machine.

#include "controller/runlog/replay.h"

#include <limits>

#include "tests/controller/runlog/runlog_fixture.h"

namespace flexarm {
namespace {

// A loop with memory: counts its steps since the reset.
class Counting {
 public:
  StepOutput operator()(const StepInput& input) {
    if (input.reset != 0) steps_ = 0;
    ++steps_;
    StepOutput output{};
    output.tick = input.tick;
    output.torque_nm = {static_cast<double>(steps_), -0.0};
    return output;
  }

 private:
  int steps_ = 0;
};

std::vector<TickRecord> Recorded(int ticks) {
  Counting loop;
  std::vector<TickRecord> records;
  for (int tick = 10; tick < 10 + ticks; ++tick) {
    TickRecord record = MakeTick(tick);
    record.input.reset = tick == 10 ? 1 : 0;
    record.output = loop(record.input);
    records.push_back(record);
  }
  return records;
}

ReplayResult Replayed(const std::vector<TickRecord>& records, bool other_config = false) {
  Replay replay(Counting(), other_config);
  for (const TickRecord& record : records) replay.Tick(record);
  return replay.Result();
}

TEST(Replay, TheSameLoopIsBitExact) {
  const ReplayResult result = Replayed(Recorded(5));
  EXPECT_EQ(result.ticks, 5);
  EXPECT_EQ(result.bit_exact, true);
  EXPECT_EQ(result.max_torque_difference_nm, (std::array<double, 2>{0, 0}));
  EXPECT_FALSE(result.first_gap_tick.has_value());
  EXPECT_FALSE(result.first_different_tick.has_value());
  EXPECT_FALSE(result.safety_exact.has_value());
}

// The log of a trip outside a run begins in the middle of the loop's memory.
TEST(Replay, TheComparisonBeginsWithTheFirstReset) {
  auto records = Recorded(8);
  for (std::size_t i = 0; i < 5; ++i) records[i].input.reset = 0;
  records[5].input.reset = 1;
  for (std::size_t i = 5; i < 8; ++i) records[i].output.torque_nm[0] -= 5.0;
  const ReplayResult result = Replayed(records);
  EXPECT_EQ(result.ticks, 8);
  EXPECT_EQ(result.ticks_before_reset, 5);
  EXPECT_EQ(result.bit_exact, true);
  records[6].output.torque_nm[0] += 1.0;
  EXPECT_EQ(Replayed(records).bit_exact, false);

  records.resize(5);
  const ReplayResult none = Replayed(records);
  EXPECT_EQ(none.ticks_before_reset, 5);
  EXPECT_FALSE(none.bit_exact.has_value()) << "nothing was compared";
  EXPECT_FALSE(none.estimate_difference.has_value());
}

TEST(Replay, TheEstimateIsComparedWithTheLargestValueOfItsState) {
  auto records = Recorded(5);
  for (TickRecord& record : records) record.output.x_hat = {};
  EXPECT_EQ(Replayed(records).estimate_difference, 0.0);
  records[1].output.x_hat[3] = 4e-9;  // Counting finds 0
  records[2].output.x_hat[3] = -1e-9;
  EXPECT_EQ(Replayed(records).estimate_difference, 1.0);
  EXPECT_FALSE(Replayed(records, true).estimate_difference.has_value());
  records[2].output.x_hat[5] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(Replayed(records).estimate_difference, std::numeric_limits<double>::infinity());
}

TEST(Replay, ASignOfZeroIsADifferenceWithoutATorqueDifference) {
  auto records = Recorded(5);
  records[3].output.torque_nm[1] = 0.0;
  const ReplayResult result = Replayed(records);
  EXPECT_EQ(result.bit_exact, false);
  EXPECT_EQ(result.first_different_tick, 13);
  EXPECT_EQ(result.max_torque_difference_nm[1], 0);
}

TEST(Replay, ATorqueDifferenceIsTheLargestOfItsJoint) {
  auto records = Recorded(5);
  records[1].output.torque_nm[0] += 0.5;
  records[2].output.torque_nm[0] -= 2;
  EXPECT_EQ(Replayed(records).max_torque_difference_nm[0], 2);
  EXPECT_EQ(Replayed(records).first_different_tick, 11);
}

TEST(Replay, ANanOnOneSideIsADifference) {
  auto records = Recorded(5);
  records[2].output.torque_nm[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isinf(Replayed(records).max_torque_difference_nm[0]));
}

TEST(Replay, ALostRecordIsAGapAndADifference) {
  auto records = Recorded(6);
  records.erase(records.begin() + 2);
  const ReplayResult result = Replayed(records);
  EXPECT_EQ(result.first_gap_tick, 12);
  EXPECT_EQ(result.bit_exact, false);
}

TEST(Replay, UnderAnotherConfigBytesAreNotCompared) {
  auto records = Recorded(5);
  records[2].output.torque_nm[0] += 1;
  const ReplayResult result = Replayed(records, true);
  EXPECT_FALSE(result.bit_exact.has_value());
  EXPECT_EQ(result.max_torque_difference_nm[0], 1);
}

std::vector<SafetyRecord> SafetyStory() {
  const SafetyRecord arm = MakeSafety(1, kIdleStatus, RequestKind::kArm);
  const SafetyRecord run = MakeSafety(2, arm.after, RequestKind::kRun);
  const SafetyRecord trip =
      MakeSafety(3, run.after, RequestKind::kNone, CauseBit(TripCause::kEmergencyStop));
  return {arm, run, trip};
}

ReplayResult Replayed(const std::vector<SafetyRecord>& records) {
  Replay replay(Counting(), false);
  for (const SafetyRecord& record : records) replay.Safety(record);
  return replay.Result();
}

TEST(ReplayOfSafety, TheSameTransitionsAreExact) {
  const auto story = SafetyStory();
  EXPECT_EQ(story[2].after.state, SafetyState::kTripped);
  const ReplayResult result = Replayed(story);
  EXPECT_EQ(result.safety_exact, true);
  EXPECT_EQ(result.safety_records, 3);
}

TEST(ReplayOfSafety, AnotherTransitionIsADifference) {
  auto story = SafetyStory();
  story[2].after.cause = TripCause::kDriveFault;
  EXPECT_EQ(Replayed(story).safety_exact, false);
  EXPECT_EQ(Replayed(story).first_different_safety_ns, 3);
}

TEST(ReplayOfSafety, AnotherRefusalIsADifference) {
  auto story = SafetyStory();
  story[0].refusal = Refusal::kNotAtRest;
  EXPECT_EQ(Replayed(story).safety_exact, false);
}

TEST(ReplayOfSafety, AMissingRecordIsADifference) {
  auto story = SafetyStory();
  story.erase(story.begin() + 1);
  EXPECT_EQ(Replayed(story).safety_exact, false);
}

}  // namespace
}  // namespace flexarm
