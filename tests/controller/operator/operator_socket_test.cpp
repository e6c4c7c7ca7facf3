#include "controller/operator/operator_socket.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <algorithm>
#include <deque>
#include <filesystem>
#include <fstream>
#include <memory>

#include "controller/types/rejected_error.h"
#include "tests/controller/operator/peers.h"
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

// A line of each client, then the next one of each.
TEST_F(OperatorSocketTest, EveryLineComesOnceAndItsReplyReachesItsClient) {
  OperatorSocket server(path_);
  SocketPeer first(path_);
  SocketPeer second(path_);
  first.Send("one\ntwo\n");
  second.Send("three\n");
  const std::vector<OperatorSocket::Message> messages = server.Poll();
  ASSERT_EQ(messages.size(), 3u);
  EXPECT_EQ(messages[0].line, "one");
  EXPECT_EQ(messages[1].line, "three");
  EXPECT_EQ(messages[2].line, "two");
  EXPECT_TRUE(server.Poll().empty());
  server.Reply(messages[1].client, "to the second");
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
  while (sent <= OperatorConnection::kMaxLine) {
    const std::size_t taken = bad.Send(much);
    sent += taken;
    EXPECT_TRUE(server.Poll().empty());
    if (taken == 0) break;  // closed
  }
  EXPECT_GT(sent, OperatorConnection::kMaxLine / 2);
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

// A new client is always heard: the one that has been quiet the longest is closed, and is told so.
TEST_F(OperatorSocketTest, ANewClientReplacesTheQuietestOne) {
  OperatorSocket server(path_);
  std::deque<SocketPeer> clients;
  for (std::size_t k = 0; k < OperatorSocket::kMaxClientsOfUser; ++k) clients.emplace_back(path_);
  EXPECT_TRUE(server.Poll().empty());
  clients[0].Send("here\n");
  const int here = server.Poll().at(0).client;
  server.Reply(here, "yes");
  SocketPeer extra(path_);
  extra.Send("stop\n");
  const std::vector<OperatorSocket::Message> messages = server.Poll();
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_EQ(messages[0].line, "stop");
  EXPECT_TRUE(clients[1].closed());
  EXPECT_THAT(clients[1].Line().value_or(""), HasSubstr("too many clients"));
  for (std::size_t k = 0; k < clients.size(); ++k) EXPECT_EQ(clients[k].closed(), k == 1) << k;
  server.Reply(messages[0].client, "stopping");
  EXPECT_EQ(extra.Line(), "stopping");
}

TEST_F(OperatorSocketTest, AClientThatWaitsForAnAnswerIsReplacedLast) {
  OperatorSocket server(path_);
  std::deque<SocketPeer> waiting;
  for (std::size_t k = 0; k + 1 < OperatorSocket::kMaxClientsOfUser; ++k) {
    waiting.emplace_back(path_).Send("calibrate\n");
  }
  server.Poll();
  for (int k = 0; k < 50; ++k) server.Poll();  // longer than the next one
  const SocketPeer idle(path_);
  server.Poll();
  for (int k = 0; k < 20; ++k) {
    const SocketPeer passing(path_);
    passing.Send("status\n");
    EXPECT_EQ(server.Poll().size(), 1u);
    for (SocketPeer& client : waiting) EXPECT_FALSE(client.closed()) << k;
  }
}

// Symptom: a stop waited behind the experiments of others, 10 ms each.
TEST_F(OperatorSocketTest, OfLongLinesOneIsTakenInAPollOfEachClientInTurn) {
  OperatorSocket server(path_);
  std::deque<SocketPeer> longs;
  const std::string line = std::string(OperatorConnection::kLongLine + 1, 'x') + "\n";
  for (int k = 0; k < 3; ++k) longs.emplace_back(path_).Send(line + line);
  const SocketPeer other(path_);
  std::vector<int> order;
  for (int k = 0; k < 6; ++k) {
    other.Send("stop\n");
    const std::vector<OperatorSocket::Message> messages = server.Poll();
    ASSERT_EQ(messages.size(), 2u) << k;
    EXPECT_EQ(messages[0].line, "stop") << "before the long one";
    EXPECT_EQ(messages[1].line.size() + 1, line.size());
    order.push_back(messages[1].client);
  }
  EXPECT_THAT(order, testing::ElementsAre(1, 2, 3, 1, 2, 3));
}

TEST_F(OperatorSocketTest, RootAndTheHolderOfTheLeaseAreClosedLast) {
  uid_t uid = 0;
  OperatorSocket server(path_, RolesInTests(), [&uid](int) {
    return Credentials{.uid = uid, .pid = 5, .groups = {kOperatorGroup}};
  });
  server.SetHolder(1000);
  std::deque<SocketPeer> kept, others;
  for (const uid_t of : {0u, 1000u}) {
    uid = of;
    for (int k = 0; k < 6; ++k) kept.emplace_back(path_);
    server.Poll();
  }
  uid = 1001;
  for (int k = 0; k < 4; ++k) others.emplace_back(path_);
  server.Poll();  // there are 16
  for (const uid_t of : {1002u, 1001u, 0u, 1000u}) {
    uid = of;
    const SocketPeer next(path_);
    next.Send("stop\n");
    EXPECT_EQ(server.Poll().size(), 1u) << of;
    for (SocketPeer& client : kept) EXPECT_FALSE(client.closed()) << of;
  }
}

TEST_F(OperatorSocketTest, ALineSaysHowLongItHasWaited) {
  OperatorSocket server(path_);
  const SocketPeer quick(path_);
  const SocketPeer slow(path_);
  std::string lines;
  for (std::size_t k = 0; k < 2 * OperatorSocket::kLinesPerPoll; ++k) lines += "x\n";
  slow.Send(lines);
  int longest = 0;
  for (int k = 0; k < 3; ++k) {
    quick.Send("stop\n");
    for (const OperatorSocket::Message& message : server.Poll()) {
      if (message.line == "stop") {
        EXPECT_EQ(message.waited_polls, 0);
      }
      longest = std::max(longest, message.waited_polls);
    }
  }
  EXPECT_EQ(longest, 2);
}

// However many connect and say nothing, a stop is heard in the poll after it.
TEST_F(OperatorSocketTest, SilentClientsBlockNoOther) {
  OperatorSocket server(path_);
  std::deque<SocketPeer> silent;
  for (int k = 0; k < 300; ++k) {
    silent.emplace_back(path_).Send(k % 2 == 0 ? "" : "half a line");
    if (k % OperatorSocket::kBacklog == 0) server.Poll();
    if (k % 50 != 49) continue;
    server.Poll();
    const SocketPeer operator_of_the_arm(path_);
    operator_of_the_arm.Send("stop\n");
    const std::vector<OperatorSocket::Message> messages = server.Poll();
    ASSERT_EQ(messages.size(), 1u) << k;
    EXPECT_EQ(messages[0].line, "stop");
  }
}

// Symptom: 0.9 MB of newlines held the operator task for 22 s.
TEST_F(OperatorSocketTest, AFloodOfLinesComesInPartsAndOthersAreHeardBetween) {
  OperatorSocket server(path_);
  const SocketPeer flood(path_);
  const std::string newlines(500'000, '\n');
  std::size_t lines = 0;
  for (int k = 0; k < 200; ++k) {
    flood.Send(newlines);
    const SocketPeer other(path_);
    other.Send("stop\n");
    const std::vector<OperatorSocket::Message> messages = server.Poll();
    EXPECT_LE(messages.size(), OperatorSocket::kLinesPerPoll);
    EXPECT_EQ(std::count_if(messages.begin(), messages.end(),
                            [](const auto& message) { return message.line == "stop"; }),
              1)
        << k;
    lines += messages.size();
  }
  EXPECT_EQ(lines, 200 * OperatorSocket::kLinesPerPoll);
}

// Symptom: an operator's `stop` by a program that closes at once was thrown away.
TEST_F(OperatorSocketTest, LinesOfAClientThatHasGoneAreHeard) {
  OperatorSocket server(path_);
  for (const bool gone : {true, false}) {
    SocketPeer client(path_);
    client.Send("arm\nstop\n");
    gone ? client.Close() : client.EndOfSending();
    const std::vector<OperatorSocket::Message> messages = server.Poll();
    ASSERT_EQ(messages.size(), 2u);
    EXPECT_EQ(messages[1].line, "stop");
    EXPECT_TRUE(server.Poll().empty());
    server.Reply(messages[0].client, "armed");
    server.Reply(messages[1].client, "stopping");
    if (gone) continue;
    EXPECT_EQ(client.Line(), "armed");
    EXPECT_EQ(client.Line(), "stopping");
    EXPECT_FALSE(client.closed());
    server.Poll();
    EXPECT_TRUE(client.closed()) << "it has all its answers";
  }
}

// Symptom: the answer to `pluck` of a client that had gone reached another one, which had its
// descriptor.
TEST_F(OperatorSocketTest, AnAnswerReachesNoOtherClient) {
  OperatorSocket server(path_);
  int asked = 0;
  {
    const SocketPeer gone(path_);
    gone.Send("pluck\n");
    asked = server.Poll().at(0).client;
  }
  for (int k = 0; k <= OperatorConnection::kLingerPolls; ++k) server.Poll();
  SocketPeer other(path_);
  other.Send("status\n");
  EXPECT_NE(server.Poll().at(0).client, asked);
  server.Reply(asked, "for the one that has gone");
  EXPECT_EQ(other.Line(), std::nullopt);
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

TEST_F(OperatorSocketTest, EveryUserMayConnectAndIsJudged) {
  std::vector<gid_t> groups{kOperatorGroup};
  OperatorSocket server(path_, RolesInTests(), [&groups](int) {
    return Credentials{.uid = 1000, .pid = 5, .groups = groups};
  });
  struct stat there{};
  ASSERT_EQ(stat(path_.c_str(), &there), 0);
  EXPECT_EQ(there.st_mode & 0777u, 0666u);
  const SocketPeer member(path_);
  member.Send("arm\n");
  EXPECT_EQ(server.Poll().at(0).by.role, Role::kOperate);
  groups = {kViewerGroup};
  const SocketPeer viewer(path_);
  viewer.Send("status\n");
  member.Send("arm\n");  // judged once, when it connected
  const std::vector<OperatorSocket::Message> messages = server.Poll();
  ASSERT_EQ(messages.size(), 2u);
  EXPECT_EQ(messages[0].by.role, Role::kOperate);
  EXPECT_EQ(messages[1].by.role, Role::kView);
  EXPECT_EQ(messages[1].by.name, "u1000");
  EXPECT_EQ(messages[1].by.pid, 5);
  EXPECT_TRUE(server.turned_away().empty());
}

TEST_F(OperatorSocketTest, AUserWithoutARoleIsToldSoAndNotHeard) {
  OperatorSocket server(path_, RolesInTests(),
                        [](int) { return Credentials{.uid = 1000, .pid = 5, .groups = {}}; });
  SocketPeer outsider(path_);
  outsider.Send("{\"command\": \"stop\"}\n");
  EXPECT_TRUE(server.Poll().empty());
  EXPECT_EQ(server.turned_away().size(), 1u);
  EXPECT_THAT(outsider.Line().value_or(""), HasSubstr("not-permitted"));
  EXPECT_TRUE(outsider.closed());
  server.Poll();
  EXPECT_TRUE(server.turned_away().empty());
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

TEST_F(OperatorSocketTest, TheSocketOfAnotherProgramStays) {
  const int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const UnixAddress address(path_);
  ASSERT_EQ(bind(fd, address.get(), address.size()), 0);
  EXPECT_THAT(RejectionOf(path_), HasSubstr("cannot listen"));
  EXPECT_TRUE(std::filesystem::is_socket(path_));
  close(fd);
}

TEST_F(OperatorSocketTest, AtItsEndTheSocketOfAnotherDaemonStays) {
  auto first = std::make_unique<OperatorSocket>(path_);
  std::filesystem::remove(path_);
  OperatorSocket second(path_);
  first.reset();
  const SocketPeer client(path_);
  client.Send("status\n");
  EXPECT_EQ(second.Poll().size(), 1u);
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
