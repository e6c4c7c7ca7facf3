#include "controller/operator/command_record.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/controller/operator/operator_records.h"
#include "tests/controller/operator/peers.h"

namespace flexarm {
namespace {

using Json = nlohmann::json;
using testing::IsEmpty;

constexpr std::int64_t kRecordSecond = 1'000'000'000;

class CommandRecordTest : public testing::Test {
 protected:
  Json Answered(int client, Json answer) {
    record_.Answered(now_ns_, client, &answer);
    return answer;
  }
  void AskAndAnswer(int count) {
    for (int i = 0; i < count; ++i) {
      record_.Asked(1, kAlice, "stop");
      Answered(1, {{"ok", true}, {"command", "stop"}});
    }
  }

  EventQueue events_{1'000};
  RecordedJournal journal_;
  CommandRecord record_{&events_, journal_.Report()};
  std::int64_t now_ns_ = kRecordSecond;
};

TEST_F(CommandRecordTest, AnAcceptedCommandHasItsUserInAnswerJournalAndLog) {
  record_.Asked(1, kAlice, "arm");
  const Json answer = Answered(1, {{"ok", true}, {"command", "arm"}});
  const Json by{{"name", "alice"}, {"uid", 1000}, {"pid", 11}};
  EXPECT_EQ(answer["by"], by);
  ASSERT_EQ(journal_.lines.size(), 1u);
  EXPECT_EQ(journal_.lines[0],
            RecordedJournal::Line(false, "arm by alice (uid 1000, pid 11): accepted"));
  const std::vector<RunEvent> logged = TakeEvents(&events_);
  ASSERT_EQ(logged.size(), 1u);
  EXPECT_EQ(logged[0].kind, "operator");
  EXPECT_EQ(logged[0].name, "arm");
  EXPECT_EQ(logged[0].time_ns, kRecordSecond);
  EXPECT_EQ(Json::parse(logged[0].value_json), Json({{"ok", true}, {"refusal", ""}, {"by", by}}));
}

TEST_F(CommandRecordTest, ARefusedOneAlsoHasItsReason) {
  record_.Asked(1, kAlice, "run");
  Answered(1, {{"ok", false}, {"command", "run"}, {"refusal", "busy"}, {"error", "Wait."}});
  EXPECT_EQ(journal_.lines[0],
            RecordedJournal::Line(true, "run by alice (uid 1000, pid 11): refused: Wait."));
  EXPECT_EQ(Json::parse(TakeEvents(&events_)[0].value_json)["refusal"], "busy");
}

TEST_F(CommandRecordTest, ANameThatCannotBePrintedIsNoneInJournalAndLog) {
  const std::string name("a\0\x1b[2J\n", 7);
  record_.Asked(1, kAlice, name);
  Answered(1, {{"ok", false}, {"command", name}, {"error", "no such command"}});
  EXPECT_EQ(journal_.lines[0].second,
            R"(a\x00\x1b[2J\n by alice (uid 1000, pid 11): refused: no such command)");
  EXPECT_EQ(TakeEvents(&events_)[0].name, R"(a\x00\x1b[2J\n)");
}

// An `arm` that is tested for a second is answered after a `stop` that came later.
TEST_F(CommandRecordTest, EachAnswerHasTheUserOfItsOwnCommand) {
  record_.Asked(1, kAlice, "arm");
  record_.Asked(2, kBob, "arm");
  record_.Asked(1, kAlice, "stop");
  EXPECT_EQ(Answered(1, {{"ok", true}, {"command", "stop"}})["by"]["name"], "alice");
  EXPECT_EQ(Answered(2, {{"ok", true}, {"command", "arm"}})["by"]["name"], "bob");
  EXPECT_EQ(Answered(1, {{"ok", true}, {"command", "arm"}})["by"]["name"], "alice");
  EXPECT_EQ(journal_.lines[1].second, "arm by bob (uid 1001, pid 12): accepted");
  EXPECT_FALSE(Answered(1, {{"ok", true}, {"command", "arm"}}).contains("by")) << "asked once";
}

TEST_F(CommandRecordTest, AStatusAndWhatIsNoCommandAreNotKept) {
  record_.Asked(1, kAlice, "status");
  record_.Asked(1, kAlice, "");
  EXPECT_EQ(Answered(1, {{"ok", true}, {"command", "status"}})["by"]["uid"], 1000);
  EXPECT_EQ(Answered(1, {{"ok", false}, {"error", "not a command"}})["by"]["uid"], 1000);
  EXPECT_THAT(journal_.lines, IsEmpty());
  EXPECT_THAT(TakeEvents(&events_), IsEmpty());
}

TEST_F(CommandRecordTest, AStopSaysHowItWasHeard) {
  record_.Heard(3, 120.0);
  record_.Asked(1, kAlice, "stop");
  record_.Heard(0, 5.0);
  record_.Asked(1, kAlice, "disarm");
  EXPECT_EQ(Answered(1, {{"ok", true}, {"command", "stop"}})["heard"],
            Json({{"waited_looks", 3}, {"busy_us", 120.0}}));
  EXPECT_FALSE(Answered(1, {{"ok", true}, {"command", "disarm"}}).contains("heard"));
}

TEST_F(CommandRecordTest, AFloodIsSummedUpOnceASecond) {
  record_.Follow(now_ns_);
  AskAndAnswer(CommandRecord::kMostPerSecond + 30);
  EXPECT_EQ(journal_.lines.size(), static_cast<std::size_t>(CommandRecord::kMostPerSecond));
  record_.Follow(now_ns_ + kRecordSecond / 2);
  EXPECT_EQ(journal_.lines.size(), static_cast<std::size_t>(CommandRecord::kMostPerSecond));
  record_.Follow(now_ns_ + kRecordSecond);
  EXPECT_GE(journal_.Find("30 more commands"), 0);
  journal_.lines.clear();
  AskAndAnswer(1);
  EXPECT_EQ(journal_.lines.size(), 1u);
}

TEST_F(CommandRecordTest, UsersWithoutARoleAreOneLineASecond) {
  const Peer stranger{.name = "stranger", .uid = 1002, .pid = 13, .role = Role::kNone};
  record_.Follow(now_ns_);
  for (int i = 0; i < 100; ++i) record_.TurnedAway(now_ns_, stranger);
  ASSERT_EQ(journal_.lines.size(), 1u);
  EXPECT_EQ(journal_.lines[0].second,
            "connection by stranger (uid 1002, pid 13): refused: stranger may not operate the arm");
  record_.Follow(now_ns_ + kRecordSecond);
  record_.TurnedAway(now_ns_ + kRecordSecond, stranger);
  EXPECT_EQ(journal_.lines.size(), 2u);
}

}  // namespace
}  // namespace flexarm
