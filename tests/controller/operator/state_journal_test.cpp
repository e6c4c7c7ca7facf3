#include "controller/operator/state_journal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/controller/operator/operator_records.h"
#include "tests/controller/operator/still_stack.h"
#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

struct StateJournalTest : testing::Test {
  void Follow(SafetyState state, TripCause cause = TripCause::kNone) {
    permit.state = state;
    permit.cause = cause;
    states.Follow(40 * kMs, permit);
  }

  const RigConfig config = ShippedRig();
  StillStack stack{config};
  EventQueue events{64};
  RecordedJournal journal;
  StateJournal states{&stack, &config.sensors, &events, journal.Report()};
  Permit permit{};
};

TEST_F(StateJournalTest, EachChangeIsOneLine) {
  using enum SafetyState;
  for (const SafetyState state : {kStarting, kIdle, kIdle, kArmed, kArmed, kIdle}) Follow(state);
  EXPECT_THAT(journal.lines, ElementsAre(RecordedJournal::Line(false, "Starting -> Idle"),
                                         RecordedJournal::Line(false, "Idle -> Armed"),
                                         RecordedJournal::Line(false, "Armed -> Idle")));
  EXPECT_TRUE(TakeEvents(&events).empty());
}

TEST_F(StateJournalTest, ATripIsAnErrorWithItsCauseItsChannelAndItsValues) {
  permit.evidence = {.value = 1.25, .limit = 1.0, .channel = 2, .detail = 0};
  Follow(SafetyState::kTripped, TripCause::kSoftLimit2);
  EXPECT_THAT(journal.lines,
              ElementsAre(RecordedJournal::Line(
                  true, std::string("Starting -> Tripped: soft-limit-2: joint 2 (value 1.250000, "
                                    "limit 1.000000). ") +
                            OperatorText(TripCause::kSoftLimit2))));
  EXPECT_TRUE(TakeEvents(&events).empty()) << "of no bus";
}

TEST_F(StateJournalTest, ATripOfABusIsAnEventThatNamesTheDevice) {
  stack.bus_text = "can0: node 5 is silent";
  permit.evidence = {.value = 0.0, .limit = 0.0, .channel = 1, .detail = 7};
  Follow(SafetyState::kTripped, TripCause::kBusLost);
  EXPECT_THAT(journal.lines,
              ElementsAre(RecordedJournal::Line(
                  true, std::string("Starting -> Tripped: bus-lost: can0: node 5 is silent. ") +
                            OperatorText(TripCause::kBusLost))));
  const std::vector<RunEvent> logged = TakeEvents(&events);
  ASSERT_EQ(logged.size(), 1u);
  EXPECT_EQ(logged[0].kind, "bus");
  EXPECT_EQ(logged[0].name, "bus-lost");
  EXPECT_EQ(logged[0].text, "can0: node 5 is silent");
  EXPECT_EQ(logged[0].time_ns, 40 * kMs);
}

TEST_F(StateJournalTest, ALatchedTripIsWrittenOnceAndAgainAfterItsReset) {
  using enum SafetyState;
  for (const SafetyState state : {kTripped, kTripped, kIdle, kTripped}) {
    Follow(state, TripCause::kEmergencyStop);
  }
  ASSERT_EQ(journal.lines.size(), 3u);
  EXPECT_EQ(journal.lines[1].second, "Tripped -> Idle");
  EXPECT_THAT(journal.lines[2].second, HasSubstr("Idle -> Tripped: emergency-stop"));
}

}  // namespace
}  // namespace flexarm
