#include "controller/types/trip_cause.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

#include "controller/safety/safety_machine.h"
#include "controller/types/trip_advice.h"

namespace flexarm {
namespace {

static_assert(LowestCause(CauseBit(TripCause::kEmergencyStop) | CauseBit(TripCause::kStaleFrame)) ==
              TripCause::kEmergencyStop);
static_assert(LowestCause(CauseBit(static_cast<TripCause>(kTripCauses - 1))) ==
              static_cast<TripCause>(kTripCauses - 1));
// Sets that no part of the program makes.
static_assert(LowestCause(0) == TripCause::kStateNotFinite);
static_assert(LowestCause(CauseBit(TripCause::kNone)) == TripCause::kStateNotFinite);
static_assert(LowestCause(TripCauses{1} << kTripCauses) == TripCause::kStateNotFinite);

TEST(TripCause, EveryCauseHasItsOwnMachineNameAndATextThatSaysWhatToDo) {
  std::set<std::string> names;
  for (int i = 0; i < kTripCauses; ++i) {
    const auto cause = static_cast<TripCause>(i);
    SCOPED_TRACE(i);
    const std::string name = ToString(cause);
    EXPECT_TRUE(names.insert(name).second) << name << " is given twice";
    EXPECT_EQ(name.find_first_not_of("abcdefghijklmnopqrstuvwxyz-0123456789"), std::string::npos);
    const std::string text = OperatorText(cause);
    ASSERT_FALSE(text.empty());
    EXPECT_EQ(text.back(), '.');
    if (cause != TripCause::kNone) {
      EXPECT_GT(std::count(text.begin(), text.end(), '.'), 1) << "what happened, then what to do";
    }
  }
}

TEST(TripCause, TheTextIsMadeOfItsPartsAndNoPartIsMissing) {
  for (int i = 1; i < kTripCauses; ++i) {
    const auto cause = static_cast<TripCause>(i);
    SCOPED_TRACE(ToString(cause));
    const TripAdvice advice = AdviceOf(cause);
    for (const std::string part : {advice.happened, advice.check, advice.remedy}) {
      ASSERT_FALSE(part.empty());
      EXPECT_EQ(part.back(), '.');
    }
    EXPECT_EQ(OperatorText(cause),
              std::string(advice.happened) + " " + advice.check + " " + advice.remedy);
  }
  EXPECT_STREQ(AdviceOf(static_cast<TripCause>(255)).remedy, "");
}

// The numbers are in logs: this test fails if a cause is renumbered.
TEST(TripCause, NamesAreThoseOfTheirNumbers) {
  EXPECT_STREQ(ToString(static_cast<TripCause>(0)), "none");
  EXPECT_STREQ(ToString(static_cast<TripCause>(1)), "limit-switch-1-low");
  EXPECT_STREQ(ToString(static_cast<TripCause>(5)), "emergency-stop");
  EXPECT_STREQ(ToString(static_cast<TripCause>(11)), "bending-strain-2");
  EXPECT_STREQ(ToString(static_cast<TripCause>(18)), "stale-frame");
  EXPECT_STREQ(ToString(static_cast<TripCause>(22)), "control-heartbeat-lost");
  EXPECT_STREQ(ToString(static_cast<TripCause>(25)), "stop-timeout");
  EXPECT_STREQ(ToString(static_cast<TripCause>(26)), "ended-while-armed");
  EXPECT_STREQ(ToString(static_cast<TripCause>(28)), "safety-lines");
  EXPECT_STREQ(ToString(static_cast<TripCause>(33)), "shutdown-timeout");
}

TEST(TripCause, ACorruptedNumberIsNamedAsSuch) {
  EXPECT_STREQ(ToString(static_cast<TripCause>(kTripCauses)), "corrupted");
  EXPECT_STREQ(ToString(static_cast<TripCause>(255)), "corrupted");
  EXPECT_STRNE(OperatorText(static_cast<TripCause>(255)), "");
}

}  // namespace
}  // namespace flexarm
