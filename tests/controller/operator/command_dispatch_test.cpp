#include "controller/operator/command_dispatch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "controller/operator/command_text.h"
#include "tests/controller/operator/operator_parts.h"
#include "tests/controller/operator/peers.h"

namespace flexarm {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kClient = 7;
constexpr const char* kOneMove =
    "name = \"one-move\"\nduration_s = 2.0\n"
    "[[move]]\nstart_s = 0.0\nduration_s = 1.8\nto_deg = [10.0, 0.0]\n";

// A rig whose calibration file is in a folder that is not there.
RigConfig UncalibratedRig(std::vector<std::string> overrides) {
  overrides.push_back("log.directory='" + testing::TempDir() + "no-such-folder'");
  return ShippedRig(overrides);
}

class CommandDispatchTest : public OperatorParts {
 protected:
  explicit CommandDispatchTest(const std::vector<std::string>& overrides = {})
      : OperatorParts(UncalibratedRig(overrides)) {}

  // As in a period: the answer to the command, or to a run that was planned.
  Json Answer(const Json& command) {
    Json answer = AnswerLine(command.dump());
    if (!answer.is_null()) return answer;
    const std::optional<ClientAnswer> planned = run_.Follow(now_, [](int) { return true; });
    return planned ? planned->json : nullptr;
  }
  Json AnswerLine(const std::string& line) { return dispatch_.Answer(kClient, by_, line, now_); }

  Peer by_ = kAlice;
  CommandRecord record_{&events_, journal_.Report()};

  CommandDispatch dispatch_{{.stack = &stack_,
                             .requests = &requests_,
                             .commissioning = &commissioning_,
                             .switches = &switches_,
                             .arm = &arm_,
                             .run = &run_,
                             .change = &change_,
                             .lease = &lease_,
                             .record = &record_,
                             .status = [] { return Json{{"ok", true}, {"tick", 12}}; },
                             .report = journal_.Report()}};
};

struct UnprovenRigTest : CommandDispatchTest {
  UnprovenRigTest() : CommandDispatchTest({"commissioning.prove_before_run=true"}) {}
};

struct LostAnglesTest : CommandDispatchTest {
  LostAnglesTest() : CommandDispatchTest({"commissioning.angles_at_start=lost"}) {}
};

TEST_F(CommandDispatchTest, WhatIsNoCommandIsAnsweredAndChangesNothing) {
  const std::string deep(200'000, '[');
  for (const std::string& line :
       {std::string(), std::string("arm"), std::string("{"), std::string("null"),
        std::string("[\"arm\"]"), std::string("{}"), std::string("{\"command\": 3}"),
        std::string("{\"command\": [\"arm\"]}"), std::string("{\"command\": \"arm\"} x"),
        std::string("{\"command\": \"\xff\xfe\"}"), std::string("\0\0", 2), deep}) {
    const Json answer = AnswerLine(line);
    EXPECT_EQ(answer["ok"], false) << line.substr(0, 40);
    EXPECT_THAT(answer.value("error", ""), HasSubstr("not a command")) << line.substr(0, 40);
    EXPECT_THAT(answer.value("remedy", ""), HasSubstr("flexarm")) << line.substr(0, 40);
  }
  EXPECT_THAT(stack_.TakeRequests(), IsEmpty());
}

TEST_F(CommandDispatchTest, AViewerSeesTheStatusAndStops) {
  by_.role = Role::kView;
  EXPECT_EQ(Answer({{"command", "status"}})["ok"], true);
  for (const char* name : {"arm", "run", "disarm", "reset", "pluck", "sim", "none"}) {
    const Json answer = Answer({{"command", name}});
    EXPECT_EQ(answer["refusal"], "not-permitted") << name;
    EXPECT_EQ(answer["command"], name);
    EXPECT_EQ(answer["state"], "Armed");
  }
  EXPECT_THAT(stack_.TakeRequests(), IsEmpty());
  EXPECT_TRUE(Answer({{"command", "stop"}}).is_null()) << "it is asked for";
}

TEST_F(CommandDispatchTest, AnUnknownCommandIsAnsweredWithThoseThatThereAre) {
  for (const char* name : {"Arm", "none", "", "shutdown"}) {
    const Json answer = Answer({{"command", name}});
    EXPECT_EQ(answer["ok"], false) << name;
    EXPECT_THAT(answer.value("error", ""), HasSubstr(std::string("'") + name + "'"));
    EXPECT_THAT(answer.value("remedy", ""),
                HasSubstr("arm, run, pause, resume, speed, retarget, stop, "
                          "disarm, reset"))
        << name;
  }
  EXPECT_THAT(stack_.TakeRequests(), IsEmpty());
}

TEST_F(CommandDispatchTest, AValueOfTheWrongTypeIsAnsweredWithItsKey) {
  for (const auto& [command, key] :
       {std::pair<Json, const char*>{{{"command", "sim"}, {"line", 3}, {"level", 0}}, "'line'"},
        {{{"command", "run"}, {"experiment", 3}}, "'experiment'"},
        {{{"command", "run"}, {"name", nullptr}, {"experiment", ""}}, "'name'"}}) {
    const Json answer = Answer(command);
    EXPECT_EQ(answer["ok"], false) << command;
    EXPECT_THAT(answer.value("error", ""), HasSubstr(std::string("expected a text in ") + key));
  }
  EXPECT_THAT(stack_.TakeRequests(), IsEmpty());
  EXPECT_THAT(journal_.lines, IsEmpty());
}

TEST_F(CommandDispatchTest, ALevelIsZeroOrOneAndNothingElse) {
  for (const Json& level : {Json("up"), Json(0.9), Json(2), Json(-1), Json(true), Json(1e300),
                            Json(4294967296), Json(), Json::array({1})}) {
    const Json answer = Answer({{"command", "sim"}, {"line", "emergency-stop"}, {"level", level}});
    EXPECT_THAT(answer.value("error", ""), HasSubstr("no such line or level")) << level;
  }
}

// Brackets within brackets take stack when JSON is copied or written: deeper than 32 is no command,
// wherever they are; within a text they are text.
TEST_F(CommandDispatchTest, DeepBracketsAreNoCommand) {
  const auto with = [](const std::string& value) {
    return "{\"command\": \"pluck\", \"x\": " + value + "}";
  };
  for (const int depth : {32, 20'000, 500'000}) {
    const auto n = static_cast<std::size_t>(depth);
    for (const std::string& value : {std::string(n, '[') + std::string(n, ']'), std::string(n, '['),
                                     "\"\\\"" + std::string(n, '[') + "\"" + std::string(n, '[')}) {
      EXPECT_THAT(AnswerLine(with(value)).value("error", ""), HasSubstr("not a command")) << depth;
    }
  }
  const auto error = [this](const std::string& line) {
    const Json answer = AnswerLine(line);
    return answer.is_null() ? std::string() : answer.value("error", "");  // null: it is carried out
  };
  EXPECT_THAT(error(with(std::string(31, '[') + std::string(31, ']'))),
              testing::Not(HasSubstr("not a command")));
  EXPECT_THAT(error(with("\"\\\"" + std::string(100, '[') + "\"")),
              testing::Not(HasSubstr("not a command")));
}

// A line of 1 MB with 300,000 lists took 50 MB and the time of a period.
TEST_F(CommandDispatchTest, ALineWithManyValuesIsNoCommand) {
  const auto with = [](int values) {
    std::string line = "{\"command\": \"status\", \"x\": [0";
    for (int k = 0; k < values; ++k) line += ",0";
    return line + "]}";
  };
  EXPECT_THAT(AnswerLine(with(300'000)).value("error", ""), HasSubstr("not a command"));
  EXPECT_THAT(AnswerLine(with(kMostValues)).value("error", ""), HasSubstr("not a command"));
  EXPECT_EQ(AnswerLine(with(kMostValues - 10))["ok"], true);
  const std::string text(200'000, ',');
  EXPECT_EQ(AnswerLine(R"({"command": "status", "x": ")" + text + "\"}")["ok"], true);
}

// After SIGTERM nothing may move the arm or change the rig, and a stop is still heard.
TEST_F(CommandDispatchTest, WhileTheDaemonEndsOnlyStatusStopAndDisarmAreAccepted) {
  now_.shutting_down = true;
  now_.permit.state = SafetyState::kStopping;
  for (const char* name : {"arm", "run", "reset", "tare", "zero", "calibrate", "pluck", "home",
                           "prove-switches", "sim", "none"}) {
    const Json answer = Answer({{"command", name}});
    EXPECT_EQ(answer.value("refusal", ""), "shutting-down") << name;
    EXPECT_EQ(answer.value("command", ""), name);
    EXPECT_EQ(answer.value("state", ""), "Stopping");
    EXPECT_THAT(answer.value("error", ""), HasSubstr("shutting down"));
  }
  EXPECT_THAT(stack_.TakeRequests(), IsEmpty());
  EXPECT_EQ(Answer({{"command", "status"}})["tick"], 12);
  EXPECT_TRUE(Answer({{"command", "stop"}}).is_null());
  EXPECT_TRUE(Answer({{"command", "disarm"}}).is_null());
}

TEST_F(CommandDispatchTest, StatusIsAnsweredAtOnce) {
  EXPECT_EQ(Answer({{"command", "status"}}),
            Json({{"ok", true}, {"tick", 12}, {"command", "status"}, {"state", "Armed"}}));
}

TEST_F(CommandDispatchTest, ARequestGoesToTheSafetyTaskWhateverTheState) {
  for (const RequestKind kind : {RequestKind::kArm, RequestKind::kReset}) {
    EXPECT_TRUE(Answer({{"command", ToString(kind)}}).is_null()) << "its answer comes later";
    const std::vector<OperatorRequest> made = stack_.TakeRequests();
    ASSERT_EQ(made.size(), 1u);
    EXPECT_EQ(made[0].kind, kind);
    EXPECT_EQ(made[0].not_before_ns, 60 * kMs);
    Answered(kind, made[0].number, Refusal::kNone);
    EXPECT_THAT(clients_, testing::ElementsAre(kClient));
  }
}

TEST_F(CommandDispatchTest, AnArmThatCannotBeKeptIsRefusedWithTheFileAndTheRemedy) {
  now_.permit.state = SafetyState::kIdle;
  std::filesystem::remove_all(folder_.path());
  const Json answer = Answer({{"command", "arm"}});
  EXPECT_EQ(answer["ok"], false);
  EXPECT_EQ(answer["refusal"], "not-kept");
  EXPECT_EQ(answer["state"], "Idle");
  EXPECT_THAT(answer.value("error", ""),
              testing::AllOf(HasSubstr(TripLatch::kFile), HasSubstr("No such file"),
                             HasSubstr("would not survive a restart")));
  EXPECT_THAT(stack_.TakeRequests(), IsEmpty());
}

TEST_F(CommandDispatchTest, AStopAndADisarmAreLatchedHoweverManyCome) {
  for (int i = 0; i < 300; ++i) {
    EXPECT_TRUE(Answer({{"command", "stop"}}).is_null());
    EXPECT_TRUE(Answer({{"command", "disarm"}}).is_null());
  }
  Answered(RequestKind::kStop, stack_.stop().Take(), Refusal::kWrongState);
  EXPECT_EQ(clients_.size(), 300u);
  Answered(RequestKind::kDisarm, stack_.disarm().Take(), Refusal::kNone);
  EXPECT_EQ(clients_.size(), 300u);
  EXPECT_THAT(stack_.TakeRequests(), IsEmpty());
}

TEST_F(CommandDispatchTest, ASecondRequestInOnePollIsRefusedAsBusy) {
  const Json run{{"command", "run"}, {"experiment", kOneMove}};
  EXPECT_TRUE(Answer(run).is_null());
  for (const Json& second : {run, Json{{"command", "arm"}}, Json{{"command", "reset"}}}) {
    const Json answer = Answer(second);
    EXPECT_EQ(answer["ok"], false) << second;
    EXPECT_EQ(answer["refusal"], "busy") << second;
    EXPECT_EQ(answer["command"], second["command"]);
  }
  EXPECT_EQ(Answer({{"command", "home"}, {"joint", 1}, {"side", "low"}})["ok"], false);
  EXPECT_EQ(stack_.TakeRequests().size(), 1u);
}

// Before the plan is there nothing is asked of the safety task, and yet it is one job.
TEST_F(CommandDispatchTest, WhileAJobIsUnderWayNoOtherMayAddEnergy) {
  const Json run{{"command", "run"}, {"experiment", kOneMove}};
  EXPECT_TRUE(AnswerLine(run.dump()).is_null());  // being planned
  for (const Json& second : {run, Json{{"command", "arm"}}, Json{{"command", "pluck"}},
                             Json{{"command", "home"}, {"joint", 1}, {"side", "low"}}}) {
    const Json answer = AnswerLine(second.dump());
    EXPECT_EQ(answer["refusal"], "busy") << second;
    EXPECT_EQ(answer["error"], "the planning of a run is under way");
  }
  EXPECT_THAT(stack_.TakeRequests(), IsEmpty());
  EXPECT_TRUE(AnswerLine(R"({"command": "reset"})").is_null()) << "it adds none";
  EXPECT_EQ(stack_.TakeRequests().at(0).kind, RequestKind::kReset);
}

TEST_F(CommandDispatchTest, ACommandOfCommissioningIsAJob) {
  EXPECT_TRUE(Answer({{"command", "pluck"}}).is_null());
  Answered(RequestKind::kRun, stack_.TakeRequests().at(0).number, Refusal::kNone);
  for (const char* name : {"arm", "run", "pluck", "home"}) {
    EXPECT_EQ(Answer({{"command", name}})["refusal"], "busy") << name;
  }
  EXPECT_TRUE(Answer({{"command", "stop"}}).is_null());
}

TEST_F(CommandDispatchTest, OthersThanTheHolderOfTheLeaseAreRefused) {
  lease_.Armed(now_.now_ns, by_);
  by_ = kBob;
  const Json answer = Answer({{"command", "run"}, {"experiment", kOneMove}});
  EXPECT_EQ(answer["refusal"], "held-by");
  EXPECT_EQ(answer["command"], "run");
  EXPECT_EQ(Answer({{"command", "status"}})["ok"], true);
  EXPECT_TRUE(Answer({{"command", "stop"}}).is_null());
  EXPECT_TRUE(
      Answer({{"command", "run"}, {"experiment", kOneMove}, {"take_over", true}}).is_null());
  EXPECT_EQ(lease_.holder(), 1001u);
}

TEST_F(CommandDispatchTest, ASimulatedLineIsSetAndWrittenToTheJournal) {
  EXPECT_EQ(Answer({{"command", "sim"}, {"line", "limit-2-high"}, {"level", 0}}),
            Json({{"ok", true},
                  {"command", "sim"},
                  {"state", "Armed"},
                  {"line", "limit-2-high"},
                  {"level", 0}}));
  EXPECT_EQ(stack_.pressed.line, Line::kLimit2High);
  EXPECT_EQ(stack_.pressed.level, 0);
  EXPECT_THAT(journal_.lines, testing::ElementsAre(RecordedJournal::Line(
                                  false, "simulated line limit-2-high set to 0")));
}

TEST_F(CommandDispatchTest, ALineOrLevelThatThereIsNotIsRefused) {
  for (const Json& command :
       {Json{{"command", "sim"}}, Json{{"command", "sim"}, {"line", "limit-3-low"}, {"level", 0}},
        Json{{"command", "sim"}, {"line", "emergency-stop"}},
        Json{{"command", "sim"}, {"line", "emergency-stop"}, {"level", 2}}}) {
    const Json answer = Answer(command);
    EXPECT_THAT(answer.value("error", ""), HasSubstr("no such line")) << command;
    EXPECT_EQ(answer["refusal"], "bad-request") << command;
  }
  EXPECT_EQ(stack_.pressed.level, -1);
}

TEST_F(CommandDispatchTest, ARealRigHasNoSimulatedLines) {
  stack_.is_simulated = false;
  const Json answer = Answer({{"command", "sim"}, {"line", "emergency-stop"}, {"level", 0}});
  EXPECT_EQ(answer["ok"], false);
  EXPECT_THAT(answer.value("error", ""), HasSubstr("no simulated switches"));
  EXPECT_EQ(answer["refusal"], "not-simulated");
  EXPECT_THAT(journal_.lines, IsEmpty());
}

TEST_F(CommandDispatchTest, ARefusalOfCommissioningHasAName) {
  now_.permit.state = SafetyState::kIdle;
  EXPECT_EQ(Answer({{"command", "pluck"}})["refusal"], "wrong-state");
  EXPECT_EQ(Answer({{"command", "calibrate"}, {"link", 3}})["refusal"], "bad-request");
  now_.permit.state = SafetyState::kArmed;
  EXPECT_EQ(Answer({{"command", "tare"}})["refusal"], "wrong-state");
  EXPECT_EQ(Answer({{"command", "prove-switches"}})["refusal"], "wrong-state");
  EXPECT_EQ(Answer({{"command", "home"}, {"joint", 1}})["refusal"], "bad-request") << "no side";
}

TEST_F(CommandDispatchTest, ARunIsPlannedBeforeItIsAskedFor) {
  EXPECT_TRUE(Answer({{"command", "run"}, {"name", "file"}, {"experiment", kOneMove}}).is_null());
  const std::vector<OperatorRequest> made = stack_.TakeRequests();
  ASSERT_EQ(made.size(), 1u);
  EXPECT_EQ(made[0].kind, RequestKind::kRun);
  EXPECT_EQ(made[0].run.experiment->accepted.name, "one-move");
}

TEST_F(CommandDispatchTest, ARunThatIsNotArmedIsRefusedBeforeItIsRead) {
  now_.permit.state = SafetyState::kIdle;
  const Json answer = Answer({{"command", "run"}, {"experiment", "not an experiment"}});
  EXPECT_EQ(answer, Json({{"ok", false},
                          {"refusal", "wrong-state"},
                          {"command", "run"},
                          {"state", "Idle"},
                          {"error", "The arm is not armed. Run `flexarm arm` first."}}));
  EXPECT_THAT(stack_.TakeRequests(), IsEmpty());
}

TEST_F(CommandDispatchTest, AnExperimentThatCannotBeReadOrPlannedIsRefused) {
  EXPECT_THAT(Answer({{"command", "run"}, {"name", "my.toml"}, {"experiment", "duration_s = x"}})
                  .value("error", ""),
              HasSubstr("my.toml"));
  const std::string far =
      "name = \"far\"\nduration_s = 2.0\n[[move]]\nstart_s = 0.0\n"
      "duration_s = 1.8\nto_deg = [170.0, 0.0]\n";
  EXPECT_THAT(Answer({{"command", "run"}, {"experiment", far}}).value("error", ""),
              HasSubstr("move"));
  EXPECT_THAT(stack_.TakeRequests(), IsEmpty());
  EXPECT_EQ(experiments_.name(), "");
}

TEST_F(UnprovenRigTest, ARunIsRefusedUntilTheWiringIsProven) {
  const Json answer = Answer({{"command", "run"}, {"experiment", kOneMove}});
  EXPECT_EQ(answer["ok"], false);
  EXPECT_THAT(answer.value("error", ""), HasSubstr("flexarm pluck"));
  EXPECT_EQ(answer["refusal"], "not-plucked");
  EXPECT_EQ(Answer({{"command", "home"}, {"joint", 1}, {"side", "low"}})["refusal"], "not-plucked");
  EXPECT_THAT(stack_.TakeRequests(), IsEmpty());
}

TEST_F(LostAnglesTest, ARunIsRefusedUntilTheAnglesAreKnown) {
  const Json answer = Answer({{"command", "run"}, {"experiment", kOneMove}});
  EXPECT_EQ(answer["refusal"], "angle-unknown");
  EXPECT_THAT(answer.value("error", ""), HasSubstr("flexarm zero"));
  EXPECT_THAT(stack_.TakeRequests(), IsEmpty());
}

TEST_F(CommandDispatchTest, ACommissioningCommandIsBegunOrRefusedByItsReason) {
  EXPECT_THAT(Answer({{"command", "tare"}}).value("error", ""),
              HasSubstr("needs the state Idle or Tripped"));
  EXPECT_THAT(Answer({{"command", "home"}, {"joint", 3}}).value("error", ""), HasSubstr("1 or 2"));
  EXPECT_THAT(stack_.TakeRequests(), IsEmpty());
  EXPECT_TRUE(Answer({{"command", "pluck"}}).is_null()) << "its answer comes later";
  EXPECT_EQ(stack_.TakeRequests().size(), 1u);
}

}  // namespace
}  // namespace flexarm
