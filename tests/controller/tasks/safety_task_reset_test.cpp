#include <gtest/gtest.h>

#include <optional>

#include "controller/tasks/safety_task.h"
#include "tests/controller/tasks/safety_task_bench.h"

// A reset while a drive is in fault: it waits while the drives acknowledge.

namespace flexarm {
namespace {

class SafetyTaskReset : public SafetyTaskTest {
 protected:
  void TripByADrive() {
    GoTo(SafetyState::kArmed);
    drive_.report.drive_ok = false;
    RunUntilTripped(50 * kMs);
    ASSERT_EQ(safety_.status().cause, TripCause::kDriveFault);
  }
  void PressButton() {
    lines_.levels |= LineBit(Line::kResetButton);
    RunFor(60 * kMs);  // 50 ms count as a press
    lines_.levels = kHealthyLevels;
    RunFor(5 * kMs);
  }
  std::optional<Refusal> AnswerTo(std::uint32_t number) {
    RequestAnswer answer{};
    while (answers_.Pop(&answer)) {
      if (answer.number == number) return answer.refusal;
    }
    return std::nullopt;
  }
};

TEST_F(SafetyTaskReset, NothingIsAcknowledgedWithoutARequest) {
  TripByADrive();
  PressButton();
  for (int k = 0; k < 3000; ++k) {
    RunFor(kMs);
    ASSERT_FALSE(permit().acknowledge);
  }
}

TEST_F(SafetyTaskReset, IsGrantedWhenTheDriveLeavesItsFault) {
  TripByADrive();
  PressButton();
  const std::uint32_t reset = Ask(RequestKind::kReset);
  RunFor(200 * kMs);
  EXPECT_TRUE(permit().acknowledge);
  EXPECT_FALSE(AnswerTo(reset).has_value()) << "it waits";
  EXPECT_EQ(safety_.status().state, SafetyState::kTripped);
  drive_.report.drive_ok = true;
  RunFor(5 * kMs);
  EXPECT_EQ(AnswerTo(reset), Refusal::kNone);
  EXPECT_FALSE(permit().acknowledge);
  EXPECT_EQ(safety_.status().state, SafetyState::kIdle);
}

TEST_F(SafetyTaskReset, WaitsForTheArmToBeAtRestAfterwards) {
  TripByADrive();
  PressButton();
  const std::uint32_t reset = Ask(RequestKind::kReset);
  control_.report.at_rest = false;  // the readings come back, and a rest takes half a second
  RunFor(60 * kMs);
  drive_.report.drive_ok = true;
  RunFor(500 * kMs);
  EXPECT_FALSE(AnswerTo(reset).has_value());
  EXPECT_FALSE(permit().acknowledge) << "the drives are well";
  control_.report.at_rest = true;
  RunFor(50 * kMs);
  EXPECT_EQ(AnswerTo(reset), Refusal::kNone);
}

TEST_F(SafetyTaskReset, IsRefusedAfterTwoSecondsIfTheDriveStaysInFault) {
  TripByADrive();
  PressButton();
  const std::uint32_t reset = Ask(RequestKind::kReset);
  RunFor(SafetyTask::kAcknowledgeNs + kMs);  // its first tick, and those of two seconds
  EXPECT_FALSE(AnswerTo(reset).has_value());
  RunFor(kMs);
  EXPECT_EQ(AnswerTo(reset), Refusal::kCauseRemains);
  RunFor(kMs);
  EXPECT_FALSE(permit().acknowledge);
  EXPECT_EQ(safety_.status().state, SafetyState::kTripped);
  const std::uint32_t again = Ask(RequestKind::kReset);
  RunFor(20 * kMs);
  EXPECT_TRUE(permit().acknowledge) << "a new request has its own two seconds";
  EXPECT_FALSE(AnswerTo(again).has_value());
}

TEST_F(SafetyTaskReset, WithoutTheButtonIsRefusedAtOnceAndAcknowledgesNothing) {
  TripByADrive();
  EXPECT_EQ(Now(RequestKind::kReset), Refusal::kCauseRemains);
  EXPECT_FALSE(permit().acknowledge);
}

TEST_F(SafetyTaskReset, WithAnotherCauseIsRefusedAtOnceAndAcknowledgesNothing) {
  TripByADrive();
  PressButton();
  lines_.levels &= ~LineBit(Line::kLimit1High);
  RunFor(2 * kMs);
  EXPECT_EQ(Now(RequestKind::kReset), Refusal::kCauseRemains);
  EXPECT_FALSE(permit().acknowledge);
}

// What a drive in fault, or a bus that comes back, causes itself does not stand in its own way.
TEST_F(SafetyTaskReset, OfADriveWhoseReadingsAreMissingTooAcknowledges) {
  for (const TripCause cause : {TripCause::kStaleFrame, TripCause::kNoCounterReading}) {
    SCOPED_TRACE(ToString(cause));
    drive_.report.drive_ok = true;
    control_.report.faults = 0;
    TripByADrive();
    PressButton();
    control_.report.faults = CauseBit(cause);
    RunFor(40 * kMs);
    const std::uint32_t reset = Ask(RequestKind::kReset);
    RunFor(20 * kMs);
    EXPECT_TRUE(permit().acknowledge);
    drive_.report.drive_ok = true;
    control_.report.faults = 0;
    RunFor(50 * kMs);
    EXPECT_EQ(AnswerTo(reset), Refusal::kNone);
  }
}

TEST_F(SafetyTaskReset, AnotherRequestAcknowledgesNothing) {
  TripByADrive();
  PressButton();
  EXPECT_EQ(Now(RequestKind::kArm), Refusal::kWrongState);
  EXPECT_FALSE(permit().acknowledge);
}

TEST_F(SafetyTaskReset, OfALostBusAcknowledges) {
  GoTo(SafetyState::kArmed);
  drive_.report.bus_ok = false;
  RunUntilTripped(50 * kMs);
  ASSERT_EQ(safety_.status().cause, TripCause::kBusLost);
  PressButton();
  const std::uint32_t reset = Ask(RequestKind::kReset);
  RunFor(20 * kMs);
  EXPECT_TRUE(permit().acknowledge);
  drive_.report.bus_ok = true;
  RunFor(50 * kMs);
  EXPECT_EQ(AnswerTo(reset), Refusal::kNone);
}

TEST_F(SafetyTaskReset, OfATripWithoutDriveFaultIsJudgedAtOnce) {
  GoTo(SafetyState::kArmed);
  lines_.levels &= ~LineBit(Line::kEmergencyStop);
  RunUntilTripped(50 * kMs);
  PressButton();
  lines_.levels = kHealthyLevels;
  RunFor(5 * kMs);
  EXPECT_EQ(Now(RequestKind::kReset), Refusal::kNone);
}

// In no other state, whatever waits there.
TEST_F(SafetyTaskReset, InIdleAcknowledgesNothing) {
  GoTo(SafetyState::kIdle);
  EXPECT_EQ(Now(RequestKind::kReset), Refusal::kWrongState);
  EXPECT_FALSE(permit().acknowledge);
}

}  // namespace
}  // namespace flexarm
