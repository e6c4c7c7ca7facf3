// Runs whose path is changed while they go on: the whole loop in lock step with the simulated arm.

#include "controller/operator/change_command.h"

#include <gmock/gmock.h>

#include <cmath>

#include "tests/controller/operator/operator_session.h"

namespace flexarm {
namespace {

using testing::HasSubstr;

class ChangeCommandTest : public OperatorSession {
 protected:
  ChangeCommandTest() { design_ = &ShippedPathDesign(); }

  void StartRun(const std::string& more = "", const Json& keys = Json::object()) {
    StartAtRest({"controller.name=gain-scheduled"});
    ASSERT_EQ(Ask("arm")["ok"], true);
    Json command{{"command", "run"}, {"experiment", kTwoMoves + more}};
    command.update(keys);
    ASSERT_EQ(Ask(command, kPlan_s)["state"], "Running");
  }
  Json Change(const char* name, const Json& keys = Json::object()) {
    Json command{{"command", name}};
    command.update(keys);
    return Ask(command, kPlan_s);
  }
  Json Status() { return Ask("status"); }
  Json Speed() { return Status()["run"]["speed_percent"]; }
  std::array<double, 2> HubDeg() {
    const Json angles = Status()["joint_angle_deg"];
    return {angles[0], angles[1]};
  }
  void ExpectAt(double deg1, double deg2) {
    // Coulomb friction of the shipped arm lets a hub rest within 0.3 deg of its reference.
    const auto [th1, th2] = HubDeg();
    EXPECT_NEAR(th1, deg1, 0.3);
    EXPECT_NEAR(th2, deg2, 0.3);
  }

  static constexpr const char* kMoves =
      "name = \"two-moves\"\nduration_s = 8.0\n"
      "[[move]]\nstart_s = 0.2\nduration_s = 3.0\nto_deg = [30.0, -20.0]\n"
      "[[move]]\nstart_s = 4.0\nduration_s = 3.0\nto_deg = [0.0, 10.0]\n";
  const std::string kTwoMoves = kMoves;
};

TEST_F(ChangeCommandTest, APausedArmIsAtRestUntilItIsResumedAndThenEndsAsPlanned) {
  StartRun();
  Run(1.5);
  const Json paused = Change("pause");
  EXPECT_EQ(paused["ok"], true) << paused;
  EXPECT_EQ(paused["command"], "pause");
  Run(2.5);
  EXPECT_EQ(Speed(), 0.0);
  EXPECT_EQ(Status()["run"]["duration_s"], nullptr);
  const auto before = HubDeg();
  Run(20.0);
  const auto after = HubDeg();
  EXPECT_EQ(State(), "Running") << "however long";
  for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(after[i], before[i], 0.1) << "at rest";
  EXPECT_GT(before[0], 3.0) << "it has begun the move,";
  EXPECT_LT(before[0], 27.0) << "and not ended it";
  EXPECT_EQ(Change("pause")["refusal"], "paused");
  EXPECT_EQ(Change("speed", {{"speed_percent", 50.0}})["refusal"], "paused");
  EXPECT_EQ(Change("resume")["ok"], true);
  EXPECT_TRUE(ComesTo("Armed", 12.0));
  EXPECT_EQ(Status()["run"]["outcome"], "done");
  ExpectAt(0.0, 10.0);
}

TEST_F(ChangeCommandTest, ASlowerRunTakesLongerAndMayBecomeFasterAgain) {
  StartRun("", {{"speed_percent", 50.0}});
  EXPECT_EQ(Speed(), 50.0);
  EXPECT_NEAR(Status()["run"]["duration_s"], 16.0, 0.1);
  Run(8.4);
  ExpectAt(30.0, -20.0);
  EXPECT_EQ(Change("speed", {{"speed_percent", 100.0}})["ok"], true);
  EXPECT_EQ(Change("speed", {{"speed_percent", 101.0}})["refusal"], "bad-request");
  EXPECT_EQ(Change("speed", {{"speed_percent", 9.0}})["refusal"], "bad-request");
  EXPECT_EQ(Change("speed")["refusal"], "bad-request");
  EXPECT_TRUE(ComesTo("Armed", 5.5)) << "8 s are left at half the speed";
  ExpectAt(0.0, 10.0);
}

TEST_F(ChangeCommandTest, ANewGoalReplacesTheRestOfTheRun) {
  StartRun();
  Run(1.5);
  EXPECT_EQ(Change("retarget", {{"to_deg", {-15.0, 20.0}}})["ok"], true);
  EXPECT_TRUE(ComesTo("Armed", 8.0));
  ExpectAt(-15.0, 20.0);
  EXPECT_EQ(Status()["run"]["outcome"], "done");
}

TEST_F(ChangeCommandTest, WhatIsMalformedOrImpossibleIsRefusedAndTheRunGoesOn) {
  StartRun();
  Run(0.5);
  EXPECT_EQ(Change("retarget")["refusal"], "bad-request");
  EXPECT_EQ(Change("retarget", {{"to_deg", {0.0, "x"}}})["refusal"], "bad-request");
  EXPECT_EQ(Change("retarget", {{"to_deg", {0, 0}}, {"to_tip_m", {1, 0}}})["refusal"],
            "bad-request");
  EXPECT_EQ(Change("retarget", {{"to_tip_m", {1, 0}}, {"elbow", "up"}})["refusal"], "bad-request");
  EXPECT_EQ(Change("retarget", {{"to_deg", {0, 0}}, {"duration_s", -1}})["refusal"], "bad-request");
  const Json beyond = Change("retarget", {{"to_deg", {200.0, 0.0}}});
  EXPECT_EQ(beyond["refusal"], "change-refused");
  EXPECT_THAT(beyond.value("error", ""), HasSubstr("no duration"));
  EXPECT_EQ(Change("resume")["refusal"], "not-paused");
  EXPECT_EQ(Speed(), 100.0);
  EXPECT_TRUE(ComesTo("Armed", 9.0));
  ExpectAt(0.0, 10.0);
  EXPECT_EQ(Change("pause")["refusal"], "wrong-state");
}

TEST_F(ChangeCommandTest, AStopEndsAPausedRun) {
  StartRun();
  Run(1.0);
  ASSERT_EQ(Change("pause")["ok"], true);
  Run(2.0);
  EXPECT_EQ(Ask("stop")["ok"], true);
  EXPECT_TRUE(ComesTo("Armed"));
  EXPECT_EQ(Status()["run"]["outcome"], "stopped");
  // The next run knows nothing of the pause.
  ASSERT_EQ(Ask(Json{{"command", "run"}, {"experiment", kTwoMoves}}, kPlan_s)["ok"], true);
  EXPECT_EQ(Speed(), 100.0);
  Run(1.0);
  EXPECT_EQ(Change("pause")["ok"], true);
}

// The number of each change is in its event; experiments with lower ones are freed.
TEST_F(ChangeCommandTest, TheLoopReleasesEachExperimentThatAChangeReplaces) {
  StartRun();
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(Change("pause")["ok"], true) << i;
    Run(2.0);
    EXPECT_EQ(Change("resume")["ok"], true) << i;
    Run(1.4);
    std::uint32_t newest = 0;
    for (const RunEvent& event : TakeEvents(&events_)) {
      if (event.kind == "change") newest = Json::parse(event.value_json)["number"];
    }
    EXPECT_GT(newest, 0u);
    EXPECT_EQ(stack_->released_experiments(), newest) << i;
  }
  EXPECT_TRUE(ComesTo("Armed", 10.0));
  ExpectAt(0.0, 10.0);
}

TEST_F(ChangeCommandTest, AnnouncedChangesOfThePayloadKeepTheirTimes) {
  StartRun("[[load_change]]\nat_s = 3.5\n");
  Run(0.5);
  const Json refused = Change("pause");
  EXPECT_EQ(refused["refusal"], "change-refused");
  EXPECT_THAT(refused.value("error", ""), HasSubstr("[[load_change]]"));
}

// Each change is in the log, with the sample from which it holds as the records show it.
TEST_F(ChangeCommandTest, IsAnEventOfTheLog) {
  StartRun();
  Run(1.0);
  ASSERT_EQ(Change("speed", {{"speed_percent", 40.0}})["ok"], true);
  bool found = false;
  for (const RunEvent& event : TakeEvents(&events_)) {
    if (event.kind != "change") continue;
    found = true;
    EXPECT_EQ(event.name, "speed");
    EXPECT_EQ(event.text, "40 % of the planned speed");
  }
  EXPECT_TRUE(found);
}

class WithoutPath : public OperatorSession {};

TEST_F(WithoutPath, ALawThatFollowsNonePausesNothingButRunsSlowly) {
  StartAtRest();
  ASSERT_EQ(Ask("arm")["ok"], true);
  Json run{{"command", "run"}, {"experiment", TomlOfMove(2.0)}, {"speed_percent", 50.0}};
  ASSERT_EQ(Ask(run, kPlan_s)["ok"], true);
  Run(0.5);
  EXPECT_NEAR(Ask("status")["run"]["duration_s"], 4.0, 0.01);
  EXPECT_EQ(Ask("status")["run"]["speed_percent"], nullptr);
  for (const char* name : {"pause", "resume"}) {
    const Json refused = Ask(name);
    EXPECT_EQ(refused["refusal"], "no-path");
    EXPECT_THAT(refused.value("error", ""), HasSubstr("gain-scheduled"));
  }
}

}  // namespace
}  // namespace flexarm
