#include "controller/operator/operator_socket.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <deque>
#include <filesystem>
#include <fstream>

#include "controller/types/rejected_error.h"
#include "tests/controller/operator/socket_peer.h"
#include "tests/support/message_of.h"

namespace flexarm {
namespace {

using testing::HasSubstr;

std::string RejectionOf(const std::string& path) {
  return MessageOf<RejectedError>([&] { OperatorSocket server(path); });
}

class OperatorSocketTest : public testing::Test {
 protected:
  ~OperatorSocketTest() override {
    std::filesystem::remove_all(std::filesystem::path(path_).parent_path());
  }

  const std::string path_ = SocketPath();
};

TEST_F(OperatorSocketTest, EveryLineComesOnceAndItsReplyReachesItsClient) {
  OperatorSocket server(path_);
  SocketPeer first(path_);
  SocketPeer second(path_);
  first.Send("one\ntwo\n");
  second.Send("three\n");
  const std::vector<OperatorSocket::Message> messages = server.Poll();
  ASSERT_EQ(messages.size(), 3u);
  EXPECT_EQ(messages[0].line, "one");
  EXPECT_EQ(messages[1].line, "two");
  EXPECT_EQ(messages[2].line, "three");
  EXPECT_TRUE(server.Poll().empty());
  server.Reply(messages[2].client, "to the second");
  server.Reply(messages[0].client, "to the first");
  EXPECT_EQ(first.Line(), "to the first");
  EXPECT_EQ(second.Line(), "to the second");
  EXPECT_EQ(first.Line(), std::nullopt);
}

TEST_F(OperatorSocketTest, ALineInPiecesComesWhole) {
  OperatorSocket server(path_);
  const SocketPeer client(path_);
  client.Send("{\"command\": ");
  EXPECT_TRUE(server.Poll().empty());
  client.Send("\"status\"}\nnext");
  const std::vector<OperatorSocket::Message> messages = server.Poll();
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_EQ(messages[0].line, "{\"command\": \"status\"}");
}

TEST_F(OperatorSocketTest, AClientWithTooLongALineIsClosedAndNoOther) {
  OperatorSocket server(path_);
  SocketPeer good(path_);
  SocketPeer bad(path_);
  const std::string much(100'000, 'x');
  std::size_t sent = 0;
  while (sent <= OperatorSocket::kMaxLine) {
    const std::size_t taken = bad.Send(much);
    sent += taken;
    EXPECT_TRUE(server.Poll().empty());
    if (taken == 0) break;  // closed
  }
  EXPECT_GT(sent, OperatorSocket::kMaxLine / 2);
  EXPECT_TRUE(bad.closed());
  good.Send("here\n");
  EXPECT_EQ(server.Poll().size(), 1u);
  EXPECT_FALSE(good.closed());
}

TEST_F(OperatorSocketTest, AClientThatDoesNotReadIsClosed) {
  OperatorSocket server(path_);
  SocketPeer client(path_);
  client.Send("status\n");
  const int id = server.Poll().at(0).client;
  for (int k = 0; k < 100; ++k) server.Reply(id, std::string(100'000, 'x'));  // 10 MB: no buffer
  EXPECT_TRUE(client.closed());
}

TEST_F(OperatorSocketTest, OneClientTooManyIsClosed) {
  OperatorSocket server(path_);
  std::deque<SocketPeer> clients;
  for (std::size_t k = 0; k < OperatorSocket::kMaxClients; ++k) clients.emplace_back(path_);
  EXPECT_TRUE(server.Poll().empty());
  SocketPeer extra(path_);
  server.Poll();
  EXPECT_TRUE(extra.closed());
  for (SocketPeer& client : clients) EXPECT_FALSE(client.closed());
  clients.pop_front();
  server.Poll();
  const SocketPeer another(path_);
  another.Send("there is room again\n");
  EXPECT_EQ(server.Poll().size(), 1u);
}

TEST_F(OperatorSocketTest, LinesOfAClientThatHasGoneAreDropped) {
  OperatorSocket server(path_);
  SocketPeer gone(path_);
  const SocketPeer here(path_);
  gone.Send("arm\n");
  here.Send("status\n");
  gone.Close();
  const std::vector<OperatorSocket::Message> messages = server.Poll();
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_EQ(messages[0].line, "status");
}

TEST_F(OperatorSocketTest, AReplyToADisconnectedClientAffectsNoOther) {
  OperatorSocket server(path_);
  SocketPeer gone(path_);
  SocketPeer here(path_);
  gone.Send("arm\n");
  here.Send("status\n");
  const std::vector<OperatorSocket::Message> messages = server.Poll();
  ASSERT_EQ(messages.size(), 2u);
  gone.Close();
  server.Reply(messages[0].client, "accepted");  // a signal SIGPIPE would end the process
  server.Reply(messages[0].client, "again");
  server.Reply(messages[1].client, "idle");
  EXPECT_EQ(here.Line(), "idle");
}

TEST_F(OperatorSocketTest, OnlyItsOwnerAndGroupMayConnect) {
  const OperatorSocket server(path_);
  struct stat there{};
  ASSERT_EQ(stat(path_.c_str(), &there), 0);
  EXPECT_EQ(there.st_mode & 0777u, 0660u);
}

TEST_F(OperatorSocketTest, ItsFileIsRemovedAtItsEnd) {
  {
    const OperatorSocket server(path_);
  }
  EXPECT_FALSE(std::filesystem::exists(path_));
}

TEST_F(OperatorSocketTest, TheSocketOfADaemonThatHasEndedIsReplaced) {
  const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const UnixAddress address(path_);
  ASSERT_EQ(bind(fd, address.get(), address.size()), 0);
  close(fd);  // as when the process was killed: the file stays
  ASSERT_TRUE(std::filesystem::exists(path_));
  OperatorSocket server(path_);
  const SocketPeer client(path_);
  client.Send("status\n");
  EXPECT_EQ(server.Poll().size(), 1u);
}

TEST_F(OperatorSocketTest, TheSocketOfARunningDaemonIsNot) {
  OperatorSocket server(path_);
  EXPECT_THAT(RejectionOf(path_), HasSubstr("a daemon is listening there already"));
  const SocketPeer client(path_);
  client.Send("status\n");
  EXPECT_EQ(server.Poll().size(), 1u) << "the first one still listens";
}

TEST_F(OperatorSocketTest, AFileThatIsNoSocketIsNotReplaced) {
  std::ofstream(path_) << "notes";
  EXPECT_THAT(RejectionOf(path_), HasSubstr("cannot listen"));
  EXPECT_EQ(std::filesystem::file_size(path_), 5u);
}

TEST_F(OperatorSocketTest, AnImpossiblePathIsRejectedWithItsRemedy) {
  EXPECT_THAT(RejectionOf(path_ + "/no/folder"), HasSubstr("folder that exists"));
  EXPECT_THAT(RejectionOf(""), HasSubstr("1 to 107 characters"));
  EXPECT_THAT(RejectionOf("/tmp/" + std::string(sizeof(sockaddr_un::sun_path), 'x')),
              HasSubstr("1 to 107 characters"));
}

}  // namespace
}  // namespace flexarm
