// The whole operator task in lock step with the simulated arm; its clients on a real socket.

#include "controller/operator/operator_task.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <thread>

#include "controller/types/rejected_error.h"
#include "tests/controller/operator/operator_session.h"

namespace flexarm {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class OperatorTaskTest : public OperatorSession {};

TEST_F(OperatorTaskTest, ArmsRunsStopsAndDisarms) {
  StartAtRest();
  const Json armed = Ask("arm");
  EXPECT_EQ(armed, Json({{"ok", true}, {"command", "arm"}, {"state", "Armed"}, {"by", Me()}}));
  EXPECT_EQ(AskRun(TomlOfMove(20.0))["state"], "Running");
  EXPECT_EQ(Ask("status")["experiment"], "one-move");
  Run(1.0);
  EXPECT_EQ(Ask("stop")["ok"], true);
  EXPECT_TRUE(ComesTo("Armed"));
  EXPECT_EQ(Ask("disarm")["state"], "Idle");
  EXPECT_THAT(
      JournalTexts(),
      ElementsAre("Starting -> Idle", "Idle -> Armed", "lease: begun by " + PeerText(MyPeer()),
                  By("arm"), "Armed -> Running", By("run"), "Running -> Stopping", By("stop"),
                  "Stopping -> Armed", "Armed -> Idle", By("disarm")));
  for (const auto& [is_error, text] : journal_.lines) EXPECT_FALSE(is_error) << text;
  const std::vector<RunEvent> logged = TakeEvents(&events_);
  ASSERT_EQ(logged.size(), 6u);
  EXPECT_EQ(logged[0].kind, "lease");
  EXPECT_EQ(logged[2].kind, "experiment");
  for (const auto& [i, name] : {std::pair{1u, "arm"}, {3u, "run"}, {4u, "stop"}, {5u, "disarm"}}) {
    EXPECT_EQ(logged[i].kind, "operator");
    EXPECT_EQ(logged[i].name, name);
    EXPECT_EQ(Json::parse(logged[i].value_json)["by"], Me());
  }
}

TEST_F(OperatorTaskTest, ARejectedDesignIsNotArmed) {
  arm_checks_.design = {
      .result = ArmVerdict::Result::kFailed,
      .findings = {{.name = "rejected", .text = "radius 1.87", .remedy = "tune"}}};
  StartAtRest();
  const Json answer = Ask("arm");
  EXPECT_EQ(answer["refusal"], "design-rejected");
  EXPECT_THAT(answer.value("error", ""), HasSubstr("radius 1.87"));
  EXPECT_EQ(answer["remedy"], "tune");
  EXPECT_EQ(State(), "Idle");
  EXPECT_EQ(Ask("status")["design"]["verdict"], "rejected");
}

TEST_F(OperatorTaskTest, AnUnattendedRunWithARejectedDesignDoesNotStart) {
  arm_checks_.design.result = ArmVerdict::Result::kFailed;
  EXPECT_THROW(Start({}, TomlOfMove(2.0)), RejectedError);
  EXPECT_FALSE(std::filesystem::exists(path_));
}

// A wired rig, as far as the operator's task can tell, on a machine that is not good enough.
TEST_F(OperatorTaskTest, AnOverrideArmsIsLoggedAfterTheArmAndEndsWhenTheArmIsIdle) {
  arm_checks_.simulated = false;
  arm_checks_.check_host = [] {
    return ArmVerdict{.result = ArmVerdict::Result::kFailed,
                      .findings = {{.name = "preempt-rt", .text = "none", .remedy = "boot it"}}};
  };
  StartAtRest();
  // The check runs on a thread of its own, in a time that is not simulated.
  const auto answer_to = [this](const Json& command) {
    SocketPeer client(path_);
    client.Send(command.dump() + "\n");
    for (int i = 0; i < 500; ++i) {
      if (Json answer = AnswerTo(&client, kPeriod_s); !answer.is_null()) return answer;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return Json();
  };
  EXPECT_EQ(answer_to({{"command", "arm"}})["refusal"], "host-not-ready");
  EXPECT_EQ(State(), "Idle");
  EXPECT_EQ(answer_to({{"command", "arm"}, {"overrides", {{"host", "test"}}}})["state"], "Armed");
  EXPECT_EQ(Ask("status")["overrides"][0]["reason"], "test");
  EXPECT_EQ(Ask("status")["host"]["verdict"], "not-ready");

  std::int64_t armed_ns = INT64_MAX;
  for (SafetyRecord record{}; stack_->safety_records().Pop(&record);) {
    if (record.after.state == SafetyState::kArmed) armed_ns = std::min(armed_ns, record.due_ns);
  }
  std::vector<RunEvent> logged = TakeEvents(&events_);
  std::erase_if(logged, [](const RunEvent& event) { return event.kind != "override"; });
  ASSERT_EQ(logged.size(), 1u);
  EXPECT_GT(logged[0].time_ns, armed_ns) << "the recorder opens the run's log with the arm";

  EXPECT_EQ(Ask("disarm")["state"], "Idle");
  EXPECT_EQ(Ask("status")["overrides"], Json::array());
}

TEST_F(OperatorTaskTest, ARunEndsByItselfAndTheNextBeginsWhereItEnded) {
  StartAtRest();
  Ask("arm");
  AskRun(TomlOfMove(2.0));
  EXPECT_TRUE(ComesTo("Armed"));
  EXPECT_NEAR(Ask("status")["joint_angle_deg"][0].get<double>(), 10.0, 1.0);
  EXPECT_EQ(AskRun(TomlOfMove(2.0))["ok"], true);
  Run(1.0);
  EXPECT_NEAR(Ask("status")["joint_angle_deg"][0].get<double>(), 10.0, 1.0) << "there already";
}

TEST_F(OperatorTaskTest, WhatTheSafetyTaskRefusesIsAnsweredWithItsReason) {
  StartAtRest();
  for (const char* name : {"stop", "disarm", "reset"}) {
    const Json answer = Ask(name);
    EXPECT_EQ(answer["ok"], false) << name;
    EXPECT_EQ(answer["refusal"], "wrong-state") << name;
    EXPECT_EQ(answer["command"], name);
    EXPECT_EQ(answer["by"], Me()) << name;
    EXPECT_GE(journal_.Find(std::string(name) + " by "), 0);
    EXPECT_GE(journal_.Find(": refused: "), 0);
  }
  EXPECT_EQ(AskRun(TomlOfMove(2.0))["refusal"], "wrong-state");
  Ask("arm");
  EXPECT_EQ(Ask("arm")["error"], "The arm is already armed.");
  AskRun(TomlOfMove(20.0));
  EXPECT_EQ(AskRun(TomlOfMove(2.0))["refusal"], "wrong-state");
  EXPECT_EQ(Ask("disarm")["refusal"], "wrong-state");
  EXPECT_EQ(State(), "Running");
}

TEST_F(OperatorTaskTest, AnArmThatHasNotBeenAtRestIsNotArmed) {
  Start();
  Run(0.1);
  EXPECT_EQ(Ask("arm")["refusal"], "not-at-rest");
  Run(1.0);
  EXPECT_EQ(Ask("arm")["ok"], true);
}

TEST_F(OperatorTaskTest, AMalformedLineIsAnsweredAndTheClientStays) {
  StartAtRest();
  SocketPeer client(path_);
  client.Send("arm\n{\"command\": \n\n{\"command\": \"fly\"}\n{\"command\": \"status\"}\n");
  for (const char* error : {"not a command", "not a command", "not a command", "no such command"}) {
    const Json answer = AnswerTo(&client);
    EXPECT_EQ(answer["ok"], false);
    EXPECT_THAT(answer.value("error", ""), HasSubstr(error));
  }
  EXPECT_EQ(AnswerTo(&client)["state"], "Idle");
}

TEST_F(OperatorTaskTest, ATripIsInTheStatusUntilButtonAndReset) {
  StartAtRest();
  Ask("arm");
  AskRun(TomlOfMove(20.0));
  Run(0.5);
  EXPECT_TRUE(Ask("status")["trip"].is_null());
  EXPECT_EQ(Press("emergency-stop", 0)["ok"], true);
  Run(kPeriod_s);
  const Json status = Ask("status");
  EXPECT_EQ(status["state"], "Tripped");
  EXPECT_EQ(status["trip"]["name"], "emergency-stop");
  EXPECT_EQ(status["trip"]["text"], OperatorText(TripCause::kEmergencyStop));
  EXPECT_GE(journal_.Find("Running -> Tripped: emergency-stop"), 0);
  EXPECT_EQ(Ask("arm")["refusal"], "wrong-state");
  EXPECT_EQ(Ask("reset")["refusal"], "cause-remains");
  Press("emergency-stop", 1);
  EXPECT_EQ(Ask("reset")["refusal"], "no-reset");
  Run(3.0);  // at rest
  Press("reset-button", 1);
  Run(0.06);
  Press("reset-button", 0);
  EXPECT_EQ(Ask("reset")["state"], "Idle");
  EXPECT_TRUE(Ask("status")["trip"].is_null());
  EXPECT_EQ(operator_->trip(), TripCause::kNone)
      << "so a service that is stopped later has not failed";
}

TEST_F(OperatorTaskTest, AfterAKillTheTripIsThereUntilButtonAndReset) {
  StartAtRest();
  Ask("arm");
  AskRun(TomlOfMove(20.0));
  Run(0.5);
  Press("emergency-stop", 0);
  Run(kPeriod_s);
  const Json before = Ask("status")["trip"];
  for (int start = 0; start < 2; ++start) {
    Kill();
    Start();
    Run(1.0);
    const Json status = Ask("status");
    EXPECT_EQ(status["state"], "Tripped");
    EXPECT_EQ(status["trip"]["name"], "emergency-stop");
    EXPECT_EQ(status["trip"]["before_start"], true);
    EXPECT_EQ(status["trip"]["time_utc"], before["time_utc"]);
    EXPECT_GE(journal_.Find("from before this start: emergency-stop"), 0);
    EXPECT_EQ(Ask("arm")["refusal"], "wrong-state");
    EXPECT_EQ(Ask("reset")["refusal"], "no-reset");
    EXPECT_EQ(operator_->trip(), TripCause::kEmergencyStop);
  }
  PressReset();
  EXPECT_EQ(Ask("reset")["state"], "Idle");
  Run(kPeriod_s);
  EXPECT_EQ(operator_->trip(), TripCause::kNone) << "none of this daemon's, for the exit code";
  EXPECT_EQ(Ask("arm")["ok"], true);
  EXPECT_EQ(Ask("disarm")["ok"], true);
  Kill();
  StartAtRest();
}

TEST_F(OperatorTaskTest, AfterAKillWhileArmedTheDaemonStartsTripped) {
  StartAtRest();
  ASSERT_EQ(Ask("arm")["ok"], true);
  Kill();
  Start();
  Run(0.1);
  EXPECT_EQ(Ask("status")["trip"]["name"], "ended-while-armed");
  PressReset();
  EXPECT_EQ(Ask("reset")["state"], "Idle");
}

TEST_F(OperatorTaskTest, AShutdownWhileArmedLeavesNoTrip) {
  StartAtRest();
  Ask("arm");
  operator_->RequestShutdown();
  EXPECT_GT(RunUntilDone(7.0), 0.0);
  Kill();
  StartAtRest();
}

TEST_F(OperatorTaskTest, WithoutRoomNothingIsArmedAttendedOrNot) {
  Start({}, TomlOfMove(2.0));
  std::filesystem::remove_all(state_.path());
  EXPECT_GT(RunUntilDone(5.0), 0.0);
  EXPECT_TRUE(operator_->refused());
  EXPECT_GE(journal_.Find("arm: refused: The daemon could not write"), 0);
  const Json answer = Ask("arm");
  EXPECT_EQ(answer["refusal"], "not-kept");
  EXPECT_THAT(answer.value("error", ""), HasSubstr(TripLatch::kFile));
  EXPECT_EQ(State(), "Idle");
}

// A wrong zero in the calibration file trips at the start; a reset wants the cause gone, which
// takes another zero.
TEST_F(OperatorTaskTest, AWrongZeroThatTripsIsCorrectedWhileTripped) {
  const std::string absolute = "commissioning.angles_at_start='absolute'";  // the file's zeros hold
  StartAtRest({absolute});
  EXPECT_EQ(Ask({{"command", "zero"}, {"angle_deg", {0.0, 80.0}}}, 2.0)["ok"], true);
  Kill();
  Start({absolute, "limits.soft_angle_deg=[90.0, 70.0]"});
  EXPECT_TRUE(ComesTo("Tripped"));
  EXPECT_EQ(Ask("status")["trip"]["name"], "soft-limit-2");
  PressReset();
  EXPECT_EQ(Ask("reset")["refusal"], "cause-remains");
  EXPECT_THAT(Ask(Json{{"command", "calibrate"}, {"link", 1}, {"force_n", 1}, {"at_m", 0.5}})
                  .value("error", ""),
              HasSubstr("needs the state Idle"));
  const Json zeroed = Ask({{"command", "zero"}, {"angle_deg", {0.0, 0.0}}}, 2.0);
  EXPECT_EQ(zeroed["ok"], true) << zeroed;
  EXPECT_EQ(zeroed["state"], "Tripped") << "zero alone resets nothing";
  EXPECT_EQ(Ask({{"command", "tare"}}, 2.0)["ok"], true);
  Run(1.0);
  EXPECT_EQ(State(), "Tripped");
  EXPECT_EQ(Ask("reset")["state"], "Idle");
  EXPECT_EQ(Ask("arm")["ok"], true);
}

TEST_F(OperatorTaskTest, AShutdownWhileRunningStopsAndDisarms) {
  StartAtRest();
  Ask("arm");
  AskRun(TomlOfMove(20.0));
  Run(0.5);
  operator_->RequestShutdown();
  operator_->RequestShutdown();
  const double took_s = RunUntilDone(7.0);
  EXPECT_GT(took_s, 0.3) << "the recorder takes the last records";
  EXPECT_LT(took_s, 4.0);
  journal_.lines.erase(journal_.lines.begin(), journal_.lines.begin() + 6);  // until Running
  EXPECT_THAT(JournalTexts(), ElementsAre("shutting down: bringing the arm to rest",
                                          "Running -> Stopping", "Stopping -> Idle"))
      << "Armed for a tick";
  EXPECT_EQ(operator_->trip(), TripCause::kNone);
}

TEST_F(OperatorTaskTest, AShutdownInIdleTakesTheSettlingTime) {
  StartAtRest();
  EXPECT_FALSE(operator_->done());
  operator_->RequestShutdown();
  EXPECT_NEAR(RunUntilDone(1.0), 0.32, 1e-9) << "0.3 s after the period in which it was seen";
}

TEST_F(OperatorTaskTest, AnUnattendedRunArmsRunsAndDisarmsByItself) {
  Start({}, TomlOfMove(2.0));
  for (int k = 0; k < 500 && journal_.Find("Armed -> Idle") < 0; ++k) Run(kPeriod_s);
  EXPECT_FALSE(operator_->done()) << "the recorder takes the last records";
  EXPECT_NEAR(RunUntilDone(1.0), 0.3, 1e-9);
  EXPECT_EQ(operator_->trip(), TripCause::kNone);
  EXPECT_FALSE(operator_->refused());
  EXPECT_THAT(JournalTexts(),
              ElementsAre("Starting -> Idle", "Idle -> Armed", "arm: accepted", "Armed -> Running",
                          "run: accepted", "Running -> Stopping", "Stopping -> Armed",
                          "Armed -> Idle", "disarm: accepted"))
      << "a request is answered when it has had its effect";
  const std::vector<RunEvent> logged = TakeEvents(&events_);
  ASSERT_EQ(logged.size(), 1u);
  EXPECT_EQ(logged[0].name, "one-move");
}

TEST_F(OperatorTaskTest, AnUnattendedRunThatTripsIsRecordedForFiveSeconds) {
  Start({}, TomlOfMove(2.0, "[[sim_event]]\nat_s = 0.5\nline = \"emergency-stop\"\nlevel = 0\n"));
  EXPECT_TRUE(ComesTo("Tripped"));
  EXPECT_NEAR(RunUntilDone(10.0), 5.0, 0.05);
  EXPECT_EQ(operator_->trip(), TripCause::kEmergencyStop);
}

TEST_F(OperatorTaskTest, AShutdownOfAnUnattendedRunIsOverWithIt) {
  Start({}, TomlOfMove(20.0));
  EXPECT_TRUE(ComesTo("Running"));
  operator_->RequestShutdown();
  EXPECT_LT(RunUntilDone(7.0), 4.0);
  EXPECT_EQ(State(), "Idle");
}

TEST_F(OperatorTaskTest, AnUnattendedExperimentThatIsImpossibleEndsTheDaemonAtItsStart) {
  const std::string too_far =
      "name = \"far\"\nduration_s = 2.0\n[[move]]\nstart_s = 0.0\nduration_s = 1.8\n"
      "to_deg = [170.0, 0.0]\n";
  EXPECT_THROW(Start({}, too_far), RejectedError);
}

TEST_F(OperatorTaskTest, ASecondDaemonOnTheSocketIsRefused) {
  Start();
  EXPECT_THROW(OperatorTask second(Context()), RejectedError);
}

TEST_F(OperatorTaskTest, ACommissioningCommandInAWrongStateIsRefused) {
  StartAtRest();
  EXPECT_THAT(Ask("pluck").value("error", ""), HasSubstr("flexarm arm"));
  Ask("arm");
  EXPECT_THAT(Ask("tare").value("error", ""), HasSubstr("needs the state Idle or Tripped"));
  EXPECT_THAT(Ask("zero").value("error", ""), HasSubstr("needs the state Idle or Tripped"));
  EXPECT_EQ(State(), "Armed");
}

TEST_F(OperatorTaskTest, ACommissioningCommandIsAnsweredAtItsEndAndOthersMeanwhile) {
  StartAtRest();
  SocketPeer client(path_);
  client.Send("{\"command\": \"zero\", \"angle_deg\": [5.0, -5.0]}\n");
  Run(0.1);
  EXPECT_EQ(State(), "Idle");
  EXPECT_EQ(client.Line(), std::nullopt);
  const Json answer = AnswerTo(&client, 2.0);
  EXPECT_EQ(answer["ok"], true) << answer;
  EXPECT_EQ(answer["command"], "zero");
  EXPECT_EQ(answer["state"], "Idle");
  EXPECT_GE(journal_.Find("zero: done, kept in " + folder().string()), 0);
  Run(1.0);
  EXPECT_NEAR(Ask("status")["joint_angle_deg"][0].get<double>(), 5.0, 0.2)
      << "the loop has its calibration";
}

TEST_F(OperatorTaskTest, ACommissioningMotionThatTheSafetyTaskRefusesIsAnswered) {
  StartAtRest();
  Ask("arm");
  SocketPeer client(path_);
  client.Send("{\"command\": \"disarm\"}\n{\"command\": \"pluck\"}\n");  // in one period
  const Json refused = AnswerTo(&client);  // before the disarm's, which waits for the relay
  EXPECT_EQ(refused["ok"], false);
  EXPECT_EQ(refused["refusal"], "wrong-state");
  EXPECT_EQ(AnswerTo(&client), Json({{"ok", true}, {"command", "disarm"}, {"state", "Idle"}}));
  Run(1.0);  // at rest
  EXPECT_EQ(Ask("arm")["ok"], true);
  const Json pluck = Ask(Json{{"command", "pluck"}}, 20.0);
  EXPECT_EQ(pluck["passed"], true) << pluck;
}

TEST_F(OperatorTaskTest, AClientThatLeavesBeforeItsAnswerAffectsNoOther) {
  StartAtRest();
  {
    const SocketPeer gone(path_);
    gone.Send("{\"command\": \"arm\"}\n");
    Run(kPeriod_s);  // the request is made
  }
  EXPECT_EQ(State(), "Armed") << "it was carried out";
  EXPECT_EQ(Ask("disarm"),
            Json({{"ok", true}, {"command", "disarm"}, {"state", "Idle"}, {"by", Me()}}));
  {
    const SocketPeer gone(path_);
    gone.Send("{\"command\": \"tare\"}\n");
    Run(kPeriod_s);
  }
  Run(2.0);
  EXPECT_GE(journal_.Find("tare: done"), 0);
  EXPECT_EQ(State(), "Idle");
}

TEST_F(OperatorTaskTest, TheWatchdogIsNotFedBeforeTheFirstPermit) {
  Start();
  Run(kPeriod_s);
  EXPECT_EQ(alive_ns_, -1) << "no permit holds before instant 0";
  Run(kPeriod_s);
  EXPECT_EQ(alive_ns_, kPeriodNs);
}

TEST_F(OperatorTaskTest, TheWatchdogIsFedOnlyWhileControlRuns) {
  StartAtRest();
  EXPECT_EQ(alive_ns_, now_ns_ - kPeriodNs) << "the newest period";
  Ask("arm");
  AskRun(TomlOfMove(20.0, "[[sim_event]]\nat_s = 0.5\nfreeze = \"control\"\n"));
  EXPECT_TRUE(ComesTo("Tripped"));
  Run(0.2);
  const std::int64_t last_ns = alive_ns_;
  Run(1.0);
  EXPECT_EQ(alive_ns_, last_ns);
  EXPECT_LT(last_ns, now_ns_ - 1'000 * kMs);
  EXPECT_GE(journal_.Find("not notified: the control thread"), 0);
}

}  // namespace
}  // namespace flexarm
