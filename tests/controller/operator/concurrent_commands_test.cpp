// Two clients in one period, and a client whose run is being planned: the whole operator task in
// lock step with the simulated arm.

#include <gmock/gmock.h>

#include <ctime>

#include "tests/controller/operator/operator_session.h"

namespace flexarm {
namespace {

using testing::HasSubstr;

constexpr const char* kHome = R"({"command": "home", "joint": 1, "side": "low"})";

std::string RunOf(const std::string& name, double to_deg) {
  return Json{{"command", "run"},
              {"experiment", "name = \"" + name +
                                 "\"\nduration_s = 20.0\n[[move]]\nstart_s = 0.0\n"
                                 "duration_s = 3.0\nto_deg = [" +
                                 std::to_string(to_deg) + ", 0.0]\n"}}
      .dump();
}

class ConcurrentCommandsTest : public OperatorSession {
 protected:
  // Two clients, in the order in which they are heard, each with one command in the same period.
  void SendBoth(const std::string& first, const std::string& second) {
    StartAtRest({"commissioning.switch_angle_deg=[-5.0, 5.0, -5.0, 5.0]"});
    ASSERT_EQ(Ask("arm")["state"], "Armed");
    SocketPeer one(path_), other(path_);
    Run(kPeriod_s);
    one.Send(first + "\n");
    other.Send(second + "\n");
    second_ = AnswerTo(&other);
    Run(kAnswer_s);
    const std::optional<std::string> line = one.Line();
    first_ = line ? Json::parse(*line) : Json();  // null for a home: it is answered at its end
    permit_ = stack_->operator_permits().Read().Newest().value;
  }
  std::string Running() const { return permit_.run.experiment->accepted.name; }

  Json first_, second_;
  Permit permit_ = kNoPermit;
};

TEST_F(ConcurrentCommandsTest, OfTwoRunsTheFirstRuns) {
  SendBoth(RunOf("gentle", 2.0), RunOf("far", 30.0));
  EXPECT_EQ(first_["ok"], true);
  EXPECT_EQ(second_["refusal"], "busy");
  EXPECT_EQ(permit_.state, SafetyState::kRunning);
  EXPECT_EQ(Running(), "gentle");
  EXPECT_EQ(permit_.run_number, first_["run"]);
  EXPECT_EQ(Ask("status")["run"]["name"], "gentle");
}

TEST_F(ConcurrentCommandsTest, OfTwoRunsInTheOtherOrderTheOtherRuns) {
  SendBoth(RunOf("far", 30.0), RunOf("gentle", 2.0));
  EXPECT_EQ(first_["ok"], true);
  EXPECT_EQ(second_["refusal"], "busy");
  EXPECT_EQ(Running(), "far");
  EXPECT_EQ(Ask("status")["experiment"], "far");
}

// Symptom: the experiment ran with the limit switch of the homing excused.
TEST_F(ConcurrentCommandsTest, ARunAfterAHomeIsRefused) {
  SendBoth(kHome, RunOf("far", 30.0));
  EXPECT_EQ(second_["refusal"], "busy");
  EXPECT_EQ(permit_.run.may_open, LineBit(Line::kLimit1Low));
  EXPECT_EQ(permit_.run.experiment->mode, LoopMode::kRegulate);
}

TEST_F(ConcurrentCommandsTest, AHomeAfterARunIsRefused) {
  SendBoth(RunOf("far", 30.0), kHome);
  EXPECT_EQ(first_["ok"], true);
  EXPECT_EQ(second_["refusal"], "busy");
  EXPECT_EQ(permit_.run.may_open, 0u);
  EXPECT_EQ(Running(), "far");
}

double Processor_s() {
  timespec spent{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &spent);
  return static_cast<double>(spent.tv_sec) + 1e-9 * static_cast<double>(spent.tv_nsec);
}

// Symptom: planning held the operator task for 2.7 s; a stop waited behind it.
TEST_F(ConcurrentCommandsTest, AStopDoesNotWaitForThePlanOf1700Moves) {
  plan_wait_ = {};
  StartAtRest();
  ASSERT_EQ(Ask("arm")["state"], "Armed");
  std::string slow = "name = \"slow\"\nduration_s = 3600.0\n";
  for (int k = 0; k < 1'700; ++k) {
    slow += "[[move]]\nstart_s = " + std::to_string(2 * k) + ".0\nto_deg = [" +
            std::to_string(k % 3) + ".0, 0.0]\n";
  }
  SocketPeer planner(path_), other(path_);
  const double began_s = Processor_s();
  planner.Send(Json{{"command", "run"}, {"experiment", slow}}.dump() + "\n");
  Run(kPeriod_s);
  other.Send("{\"command\": \"status\"}\n{\"command\": \"run\"}\n{\"command\": \"stop\"}\n");
  Run(kPeriod_s);
  EXPECT_EQ(Json::parse(*other.Line())["state"], "Armed");
  EXPECT_EQ(Json::parse(*other.Line())["refusal"], "busy");
  Run(kPeriod_s);  // it was judged in the tick after it was heard, and is answered
  const std::optional<std::string> stop = other.Line();
  ASSERT_TRUE(stop);
  EXPECT_EQ(Json::parse(*stop)["refusal"], "wrong-state") << "nothing moves yet";
  const std::optional<std::string> run = planner.Line();
  ASSERT_TRUE(run);
  EXPECT_EQ(Json::parse(*run)["refusal"], "cancelled");
  EXPECT_LT(Processor_s() - began_s, 1.0) << "of this thread, which is the operator's";
  EXPECT_THAT(State(), HasSubstr("Armed"));
}

}  // namespace
}  // namespace flexarm
