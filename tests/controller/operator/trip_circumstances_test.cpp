#include "controller/operator/trip_circumstances.h"

#include <gtest/gtest.h>

#include "tests/controller/operator/operator_records.h"

namespace flexarm {
namespace {

constexpr std::int64_t kPeriodOfOperatorNs = 20'000'000;

class TripCircumstancesTest : public testing::Test {
 protected:
  void Follow(SafetyState state, TripCauses causes = 0) {
    Permit permit = kNoPermit;
    permit.state = state;
    permit.renewed_ns = now_ns_ - 1'000'000;
    PresentCauses present;
    present.causes = causes;
    circumstances_.Follow(now_ns_, permit, present, {});
    now_ns_ += kPeriodOfOperatorNs;
  }
  std::vector<RunEvent> Taken(const char* kind) {
    std::vector<RunEvent> events = TakeEvents(&events_);
    std::erase_if(events, [kind](const RunEvent& event) { return event.kind != kind; });
    return events;
  }

  std::int64_t now_ns_ = kPeriodOfOperatorNs;
  int calls_ = 0;
  SensorConfig sensors_{};
  EventQueue events_{256};
  TripCircumstances circumstances_{
      {.sensors = &sensors_,
       .bus_text = [](TripCause, const Evidence&) { return std::string(); },
       .thread_status =
           [this] { return nlohmann::json::array({{{"name", "t"}, {"calls", ++calls_}}}); }},
      &events_};
};

TEST_F(TripCircumstancesTest, CountsAreThoseOfTheTripAndOfTenSecondsBefore) {
  for (int i = 0; i < 20 * 50; ++i) Follow(SafetyState::kArmed);
  EXPECT_TRUE(TakeEvents(&events_).empty());
  EXPECT_FALSE(circumstances_.IsOfLatched(0));
  Follow(SafetyState::kTripped, CauseBit(TripCause::kEmergencyStop));
  Follow(SafetyState::kTripped, CauseBit(TripCause::kEmergencyStop));
  const std::vector<RunEvent> noted = Taken("circumstances");
  ASSERT_EQ(noted.size(), 1U);
  const auto json = nlohmann::json::parse(noted[0].value_json);
  // One count a second, from the first period on: the 20th was the last of 20 s.
  EXPECT_EQ(json["threads"][0]["calls"], 21);
  EXPECT_EQ(json["threads_before"][0]["calls"], 10);
  EXPECT_NEAR(json["before_s"].get<double>(), 11.0, 1e-9);
}

TEST_F(TripCircumstancesTest, CausesAreNotedWhenTheyChangeAndNotForEver) {
  const TripCauses stop = CauseBit(TripCause::kEmergencyStop), bus = CauseBit(TripCause::kBusLost);
  Follow(SafetyState::kIdle);
  Follow(SafetyState::kTripped, stop);
  Follow(SafetyState::kTripped, stop);
  Follow(SafetyState::kTripped, stop | bus);
  const std::vector<RunEvent> noted = Taken("causes");
  ASSERT_EQ(noted.size(), 2U);
  EXPECT_EQ(nlohmann::json::parse(noted[1].value_json).size(), 2U);
  for (int i = 0; i < 100; ++i) Follow(SafetyState::kTripped, i % 2 == 0 ? stop : bus);
  EXPECT_EQ(Taken("causes").size(), TripCircumstances::kMostChanges - 2U);
}

TEST_F(TripCircumstancesTest, AReportIsOfTheTripThatIsLatched) {
  Follow(SafetyState::kIdle);
  const std::int64_t first_ns = now_ns_ - 2'000'000;  // between two looks
  Follow(SafetyState::kTripped);
  EXPECT_TRUE(circumstances_.IsOfLatched(first_ns));
  EXPECT_FALSE(circumstances_.IsOfLatched(INT64_MIN)) << "of a daemon before";
  Follow(SafetyState::kIdle);
  EXPECT_FALSE(circumstances_.IsOfLatched(first_ns));
  Follow(SafetyState::kTripped);
  EXPECT_FALSE(circumstances_.IsOfLatched(first_ns)) << "of the trip before";
}

TEST_F(TripCircumstancesTest, ATripOfADaemonBeforeIsNotNotedAgain) {
  Follow(SafetyState::kTripped);
  EXPECT_TRUE(TakeEvents(&events_).empty());
  EXPECT_TRUE(circumstances_.IsOfLatched(INT64_MIN));
}

}  // namespace
}  // namespace flexarm
