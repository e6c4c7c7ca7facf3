#include "controller/operator/lease.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "controller/types/rejected_error.h"
#include "tests/controller/operator/operator_records.h"
#include "tests/controller/operator/peers.h"
#include "tests/support/message_of.h"

namespace flexarm {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;
using testing::IsEmpty;
using enum SafetyState;

constexpr std::int64_t kSecond = 1'000'000'000;

class LeaseTest : public testing::Test {
 protected:
  Json Judge(const Peer& by, const char* name, SafetyState state = kIdle, bool take_over = false) {
    Json command{{"command", name}};
    if (take_over) command["take_over"] = true;
    return lease_.Judge(now_ns_, by, command, state);
  }
  void Follow(double seconds, SafetyState state) {
    now_ns_ += static_cast<std::int64_t>(seconds * 1e9);
    lease_.Follow(now_ns_, state);
  }

  EventQueue events_{64};
  RecordedJournal journal_;
  Lease lease_{&events_, journal_.Report()};
  std::int64_t now_ns_ = kSecond;
};

TEST_F(LeaseTest, BeforeTheFirstArmEveryOperatorCommands) {
  for (const char* name : {"arm", "run", "disarm", "tare", "reset"}) {
    EXPECT_TRUE(Judge(kAlice, name).is_null());
    EXPECT_TRUE(Judge(kBob, name).is_null());
  }
  EXPECT_EQ(lease_.holder(), std::nullopt);
  EXPECT_TRUE(lease_.Json(now_ns_).is_null());
}

TEST_F(LeaseTest, WhoArmedCommandsAndOthersAreToldWho) {
  lease_.Armed(now_ns_, kAlice);
  EXPECT_EQ(lease_.holder(), 1000u);
  for (const char* name : {"arm", "run", "disarm", "reset", "tare", "zero", "calibrate", "pluck",
                           "home", "prove-switches"}) {
    const Json answer = Judge(kBob, name, kArmed);
    EXPECT_EQ(answer["refusal"], "held-by") << name;
    EXPECT_THAT(answer.value("error", ""), HasSubstr("held-by alice")) << name;
    EXPECT_EQ(answer["held_by"]["uid"], 1000) << name;
    EXPECT_THAT(answer.value("remedy", ""), HasSubstr("--take-over")) << name;
    EXPECT_TRUE(Judge(kAlice, name, kArmed).is_null()) << name;
  }
  Peer other_process = kAlice;
  other_process.pid = 99;
  EXPECT_TRUE(Judge(other_process, "run", kArmed).is_null()) << "the lease is of the user";
}

TEST_F(LeaseTest, EveryOperatorMayLookStopAndPressASimulatedSwitch) {
  lease_.Armed(now_ns_, kAlice);
  for (const char* name : {"status", "stop", "sim"}) {
    EXPECT_TRUE(Judge(kBob, name, kRunning).is_null()) << name;
  }
}

TEST_F(LeaseTest, ItEndsAMinuteAfterTheRelayOpened) {
  for (const SafetyState open : {kIdle, kTripped}) {
    lease_.Armed(now_ns_, kAlice);
    Follow(1'000.0, kArmed);
    EXPECT_TRUE(lease_.Json(now_ns_)["seconds_left"].is_null());
    Follow(0.02, kDisarming);
    Follow(0.02, open);
    EXPECT_EQ(lease_.Json(now_ns_),
              Json({{"name", "alice"}, {"uid", 1000}, {"seconds_left", 60.0}}));
    Follow(59.9, open);
    EXPECT_EQ(Judge(kBob, "arm")["refusal"], "held-by");
    Follow(0.1, open);
    EXPECT_TRUE(Judge(kBob, "arm").is_null());
    EXPECT_EQ(lease_.holder(), std::nullopt);
  }
}

TEST_F(LeaseTest, ArmingAgainKeepsIt) {
  lease_.Armed(now_ns_, kAlice);
  Follow(0.02, kIdle);
  Follow(59.0, kIdle);
  lease_.Armed(now_ns_, kAlice);
  Follow(0.02, kArmed);
  Follow(59.0, kArmed);
  EXPECT_EQ(lease_.holder(), 1000u);
  EXPECT_EQ(TakeEvents(&events_).size(), 1u) << "one lease";
}

// An arm with tests of the power path: the relay opens between them.
TEST_F(LeaseTest, TheTestsOfThePowerPathDoNotEndIt) {
  lease_.Armed(now_ns_, kAlice);
  for (const SafetyState state : {kTestingPump, kTestingRelay, kTestingPower, kArmed}) {
    Follow(61.0, state);
    EXPECT_EQ(lease_.holder(), 1000u) << ToString(state);
  }
}

TEST_F(LeaseTest, ItCanBeTakenOverAndThatIsRecorded) {
  lease_.Armed(now_ns_, kAlice);
  TakeEvents(&events_);
  EXPECT_TRUE(Judge(kBob, "disarm", kArmed, true).is_null());
  EXPECT_EQ(lease_.holder(), 1001u);
  EXPECT_EQ(Judge(kAlice, "arm", kArmed)["held_by"]["name"], "bob");
  EXPECT_GE(journal_.Find("lease: taken over from alice (uid 1000, pid 11) by bob (uid 1001"), 0);
  const std::vector<RunEvent> logged = TakeEvents(&events_);
  ASSERT_EQ(logged.size(), 1u);
  EXPECT_EQ(logged[0].kind, "lease");
  EXPECT_EQ(logged[0].name, "taken-over");
  EXPECT_EQ(Json::parse(logged[0].value_json)["from"]["uid"], 1000);
}

TEST_F(LeaseTest, AnArmThatMovesIsNotTakenOver) {
  lease_.Armed(now_ns_, kAlice);
  for (const SafetyState state : {kRunning, kStopping, kFaultStopping}) {
    const Json answer = Judge(kBob, "disarm", state, true);
    EXPECT_EQ(answer["refusal"], "held-by") << ToString(state);
    EXPECT_THAT(answer.value("remedy", ""), HasSubstr("flexarm stop"));
    EXPECT_TRUE(Judge(kBob, "stop", state, true).is_null()) << "any operator stops";
    EXPECT_EQ(lease_.holder(), 1000u) << "and the lease stays";
  }
}

TEST_F(LeaseTest, ATakeOverThatTakesNothingIsNoEvent) {
  EXPECT_TRUE(Judge(kBob, "arm", kIdle, true).is_null());
  lease_.Armed(now_ns_, kBob);
  TakeEvents(&events_);
  EXPECT_TRUE(Judge(kBob, "run", kRunning, true).is_null());
  EXPECT_THAT(TakeEvents(&events_), IsEmpty());
  EXPECT_THAT(MessageOf<RejectedError>([&] {
                lease_.Judge(now_ns_, kBob, {{"command", "arm"}, {"take_over", 1}}, kIdle);
              }),
              HasSubstr("'take_over'"));
}

}  // namespace
}  // namespace flexarm
