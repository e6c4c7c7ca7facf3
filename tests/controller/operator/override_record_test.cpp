#include "controller/operator/override_record.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/controller/operator/operator_records.h"
#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::uint32_t kArmRequest = 1'001;
const Override kHostOverride{.condition = "host", .reason = "bench test", .found = "no PREEMPT_RT"};

class OverrideRecordTest : public testing::Test {
 protected:
  void Answer(Refusal refusal, std::uint32_t number = kArmRequest) {
    record_.Answered(100 * kMs, {.number = number,
                                 .kind = RequestKind::kArm,
                                 .refusal = refusal,
                                 .state = SafetyState::kIdle,
                                 .present = 0});
  }
  void Follow(SafetyState state, std::int64_t renewed_ns) {
    Permit permit = kNoPermit;
    permit.state = state;
    permit.renewed_ns = renewed_ns;
    record_.Follow(permit);
  }

  EventQueue events_{8};
  RecordedJournal journal_;
  OverrideRecord record_{&events_, journal_.Report()};
};

TEST_F(OverrideRecordTest, AGrantedOverrideIsInTheLogTheJournalAndTheStatus) {
  record_.Asked(kArmRequest, {kHostOverride});
  EXPECT_THAT(record_.in_force(), IsEmpty()) << "not granted yet";
  Answer(Refusal::kNone);
  EXPECT_EQ(
      record_.Json(),
      Json::array({{{"condition", "host"}, {"reason", "bench test"}, {"found", "no PREEMPT_RT"}}}));
  const std::vector<RunEvent> events = TakeEvents(&events_);
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].time_ns, 100 * kMs);
  EXPECT_EQ(events[0].kind, "override");
  EXPECT_EQ(events[0].name, "host");
  EXPECT_EQ(events[0].text, "bench test");
  EXPECT_EQ(Json::parse(events[0].value_json),
            Json({{"request", kArmRequest}, {"command", "arm"}, {"found", "no PREEMPT_RT"}}));
  ASSERT_EQ(journal_.lines.size(), 1u);
  EXPECT_TRUE(journal_.lines[0].first) << "stands out";
  EXPECT_THAT(journal_.lines[0].second, HasSubstr("'host' is overridden: bench test"));
}

TEST_F(OverrideRecordTest, ARefusedRequestLeavesNothing) {
  record_.Asked(kArmRequest, {kHostOverride});
  Answer(Refusal::kNotAtRest);
  Answer(Refusal::kNone);  // its number does not come again
  EXPECT_THAT(record_.in_force(), IsEmpty());
  EXPECT_THAT(TakeEvents(&events_), IsEmpty());
  EXPECT_THAT(journal_.lines, IsEmpty());
}

TEST_F(OverrideRecordTest, AnotherRequestDoesNotTakeIt) {
  record_.Asked(kArmRequest, {kHostOverride});
  Answer(Refusal::kNone, kArmRequest + 1);
  EXPECT_THAT(record_.in_force(), IsEmpty());
}

TEST_F(OverrideRecordTest, ItIsInForceThroughATripUntilTheArmIsIdle) {
  record_.Asked(kArmRequest, {kHostOverride});
  Answer(Refusal::kNone);
  Follow(SafetyState::kIdle, 99 * kMs);  // a permit of before the grant
  EXPECT_EQ(record_.in_force().size(), 1u);
  for (const SafetyState state :
       {SafetyState::kArmed, SafetyState::kRunning, SafetyState::kStopping, SafetyState::kTripped,
        SafetyState::kFaultStopping, SafetyState::kDisarming}) {
    Follow(state, 200 * kMs);
    EXPECT_EQ(record_.in_force().size(), 1u) << ToString(state);
  }
  Follow(SafetyState::kIdle, 300 * kMs);
  EXPECT_EQ(record_.Json(), Json::array());
}

TEST_F(OverrideRecordTest, TheNextRequestStartsWithout) {
  record_.Asked(kArmRequest, {kHostOverride});
  Answer(Refusal::kNone);
  Follow(SafetyState::kIdle, 300 * kMs);
  record_.Asked(kArmRequest + 1, {});
  Answer(Refusal::kNone, kArmRequest + 1);
  EXPECT_THAT(record_.in_force(), IsEmpty());
}

}  // namespace
}  // namespace flexarm
