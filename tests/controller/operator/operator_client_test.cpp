#include "controller/operator/operator_client.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <set>
#include <thread>
#include <vector>

#include "controller/operator/operator_socket.h"
#include "controller/operator/unix_address.h"
#include "controller/runlog/file_descriptor.h"
#include "controller/types/rejected_error.h"
#include "tests/controller/operator/socket_peer.h"
#include "tests/support/message_of.h"

namespace flexarm {
namespace {

using testing::HasSubstr;

class OperatorClientTest : public testing::Test {
 protected:
  ~OperatorClientTest() override {
    std::filesystem::remove_all(std::filesystem::path(path_).parent_path());
  }

  // Asks from another thread, and gives this one the message.
  std::string AskWhile(const std::function<void(OperatorSocket&, int)>& serve) {
    OperatorSocket server(path_);
    std::string answer;
    std::thread client([&] {
      try {
        answer = AskDaemon(path_, "{\"command\": \"status\"}", 60.0);
      } catch (const RejectedError& error) {
        answer = error.what();
      }
    });
    std::vector<OperatorSocket::Message> messages;
    while (messages.empty()) messages = server.Poll();
    EXPECT_EQ(messages[0].line, "{\"command\": \"status\"}");
    serve(server, messages[0].client);
    client.join();
    return answer;
  }

  const std::string path_ = SocketPath();
};

TEST_F(OperatorClientTest, ReturnsTheAnswerWithoutItsNewline) {
  EXPECT_EQ(AskWhile([](OperatorSocket& server, int id) { server.Reply(id, "{\"ok\": true}"); }),
            "{\"ok\": true}");
}

TEST_F(OperatorClientTest, AnAnswerLongerThanOneReadComesWhole) {
  const std::string answer(50'000, 'x');
  EXPECT_EQ(AskWhile([&](OperatorSocket& server, int id) { server.Reply(id, answer); }), answer);
}

TEST_F(OperatorClientTest, SaysThatTheDaemonHasClosedTheConnection) {
  EXPECT_THAT(AskWhile([](OperatorSocket& server, int id) {
                // More than a socket's buffer: the server closes a client that does not take it.
                server.Reply(id, std::string(5'000'000, 'x'));
              }),
              HasSubstr("the daemon closed the connection"));
}

TEST_F(OperatorClientTest, SaysWhatToStartWhenNoDaemonListens) {
  const auto ask = [&] { AskDaemon(path_, "{}", 1.0); };
  EXPECT_THAT(MessageOf<RejectedError>(ask), HasSubstr("start flexarmd"));
}

TEST_F(OperatorClientTest, GivesUpOnADaemonThatDoesNotAnswer) {
  const OperatorSocket silent(path_);
  const auto ask = [&] { AskDaemon(path_, "{}", 0.02); };
  EXPECT_THAT(MessageOf<RejectedError>(ask), HasSubstr("does not answer"));
}

// It accepts nothing: clients that have given up fill its queue, and the next cannot connect.
TEST_F(OperatorClientTest, GivesUpOnADaemonThatStandsStillHoweverOftenItIsAsked) {
  const FileDescriptor still(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  const UnixAddress address(path_);
  ASSERT_EQ(bind(still.get(), address.get(), address.size()), 0);
  ASSERT_EQ(listen(still.get(), 1), 0);
  for (int i = 0; i < 4; ++i) {
    const auto ask = [&] { AskDaemon(path_, "{}", 0.02); };
    EXPECT_THAT(MessageOf<RejectedError>(ask), HasSubstr("the daemon does not answer")) << i;
  }
}

TEST_F(OperatorClientTest, AsksOneLineAfterTheOtherOverOneConnection) {
  OperatorSocket server(path_);
  std::vector<std::string> answers;
  std::thread client([&] {
    DaemonConnection daemon(path_, 60.0);
    for (const char* line : {"one", "two", "three"}) answers.push_back(daemon.Ask(line, 60.0));
  });
  std::set<int> clients;
  for (int asked = 0; asked < 3;) {
    for (const auto& message : server.Poll()) {
      server.Reply(message.client, message.line + " answered");
      clients.insert(message.client);
      ++asked;
    }
  }
  client.join();
  EXPECT_EQ(answers, (std::vector<std::string>{"one answered", "two answered", "three answered"}));
  EXPECT_EQ(clients.size(), 1U);
}

TEST_F(OperatorClientTest, AnotherThreadEndsAWait) {
  OperatorSocket server(path_);
  DaemonConnection daemon(path_, 60.0);
  std::string told;
  std::thread client([&] { told = MessageOf<RejectedError>([&] { daemon.Ask("{}", 600.0); }); });
  while (server.Poll().empty()) {
  }
  daemon.Interrupt();
  client.join();
  EXPECT_THAT(told, HasSubstr("closed the connection"));
}

}  // namespace
}  // namespace flexarm
