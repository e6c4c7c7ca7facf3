#include "tools/dashboard/command_desk.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <future>
#include <memory>
#include <string>

#include "controller/operator/operator_socket.h"
#include "tests/controller/operator/socket_peer.h"

namespace flexarm {
namespace {

using testing::HasSubstr;

class CommandDeskTest : public testing::Test {
 protected:
  ~CommandDeskTest() override {
    std::filesystem::remove_all(std::filesystem::path(path_).parent_path());
  }

  std::future<CommandOutcome> Give(CommandDesk& desk, const char* name) {
    const auto told = std::make_shared<std::promise<CommandOutcome>>();
    const bool taken =
        desk.Take({.name = name, .line = R"({"command":")" + std::string(name) + "\"}"},
                  [told](const CommandOutcome& outcome) { told->set_value(outcome); });
    EXPECT_TRUE(taken);
    return told->get_future();
  }
  // The daemon's side: waits for a line.
  static OperatorSocket::Message Await(OperatorSocket& daemon) {
    for (;;) {
      for (const OperatorSocket::Message& message : daemon.Poll()) return message;
    }
  }

  const std::string path_ = SocketPath();
};

TEST_F(CommandDeskTest, GivesACommandAndTellsTheAnswer) {
  OperatorSocket daemon(path_);
  CommandDesk desk(path_);
  std::future<CommandOutcome> outcome = Give(desk, "arm");
  const auto asked = Await(daemon);
  EXPECT_EQ(asked.line, R"({"command":"arm"})");
  daemon.Reply(asked.client, R"({"ok":false,"error":"not at rest"})");
  const CommandOutcome told = outcome.get();
  EXPECT_TRUE(told.answered);
  EXPECT_FALSE(told.ok);
  EXPECT_EQ(told.json, R"({"ok":false,"error":"not at rest"})");
}

TEST_F(CommandDeskTest, SaysThatNoDaemonAnswers) {
  CommandDesk desk(path_);
  const CommandOutcome told = Give(desk, "stop").get();
  EXPECT_FALSE(told.answered);
  EXPECT_FALSE(told.ok);
  EXPECT_THAT(told.json, HasSubstr("no daemon answers"));
}

TEST_F(CommandDeskTest, GivesAStopAgainThatACrowdHasClosed) {
  OperatorSocket daemon(path_);
  CommandDesk desk(path_);
  std::future<CommandOutcome> outcome = Give(desk, "stop");
  daemon.Reply(Await(daemon).client, R"({"ok":false,"refusal":"too-many-clients"})");
  daemon.Reply(Await(daemon).client, R"({"ok":true})");
  EXPECT_TRUE(outcome.get().ok);
}

TEST_F(CommandDeskTest, TheEndBreaksOffWhatIsUnderWayAndWhatWaits) {
  OperatorSocket daemon(path_);
  CommandDesk desk(path_);
  std::future<CommandOutcome> first = Give(desk, "pluck"), second = Give(desk, "arm");
  Await(daemon);  // and no answer, which the desk would wait for, for ten seconds
  desk.Close();
  EXPECT_FALSE(first.get().answered);
  EXPECT_FALSE(second.get().answered);
  EXPECT_FALSE(desk.Take({.name = "arm", .line = "{}"}, [](const CommandOutcome&) {}));
}

TEST_F(CommandDeskTest, SoManyCommandsWaitAndNoMore) {
  OperatorSocket daemon(path_);
  CommandDesk desk(path_);
  Give(desk, "pluck");
  Await(daemon);
  for (std::size_t i = 0; i < CommandDesk::kMostWaiting; ++i) Give(desk, "arm");
  EXPECT_FALSE(desk.Take({.name = "arm", .line = "{}"}, [](const CommandOutcome&) {}));
}

}  // namespace
}  // namespace flexarm
