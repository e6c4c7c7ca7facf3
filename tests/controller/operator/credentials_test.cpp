#include "controller/operator/credentials.h"

#include <gmock/gmock.h>
#include <grp.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <filesystem>

#include "tests/controller/operator/socket_peer.h"

namespace flexarm {
namespace {

using testing::Contains;
using testing::IsEmpty;

TEST(Credentials, OfAConnectedSocketAreThoseOfItsProcess) {
  std::array<int, 2> ends{};
  ASSERT_EQ(socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()), 0);
  const Credentials found = CredentialsOf(ends[0]);
  EXPECT_EQ(found.uid, geteuid());
  EXPECT_EQ(found.pid, getpid());
  EXPECT_THAT(found.groups, Contains(getegid()));
  for (const int fd : ends) close(fd);
}

// A child process of another user, with groups of its own, connects and ends.
TEST(Credentials, AreKeptFromTheInstantOfTheConnection) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can become another user";
  const std::string path = SocketPath();
  const int listener = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const UnixAddress address(path);
  ASSERT_EQ(bind(listener, address.get(), address.size()), 0);
  ASSERT_EQ(listen(listener, 1), 0);
  std::filesystem::permissions(path, std::filesystem::perms::all);
  std::filesystem::permissions(std::filesystem::path(path).parent_path(),
                               std::filesystem::perms::all);
  const pid_t child = fork();
  if (child == 0) {
    const std::array<gid_t, 2> groups{4242, 4243};
    const int fd = socket(AF_UNIX, SOCK_STREAM, 0);
    const bool done = setgroups(groups.size(), groups.data()) == 0 && setgid(4244) == 0 &&
                      setuid(65'534) == 0 && connect(fd, address.get(), address.size()) == 0;
    _exit(done ? 0 : 1);
  }
  const int fd = accept4(listener, nullptr, nullptr, SOCK_CLOEXEC);
  int status = -1;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_EQ(status, 0);
  const Credentials found = CredentialsOf(fd);
  EXPECT_EQ(found.uid, 65'534u);
  EXPECT_EQ(found.pid, child);
  EXPECT_THAT(found.groups, testing::UnorderedElementsAre(4242, 4243, 4244));
  close(fd);
  close(listener);
  std::filesystem::remove_all(std::filesystem::path(path).parent_path());
}

TEST(Credentials, OfSomethingElseAreNotKnown) {
  std::array<int, 2> ends{};
  ASSERT_EQ(pipe(ends.data()), 0);
  const Credentials found = CredentialsOf(ends[0]);
  EXPECT_EQ(found.uid, static_cast<uid_t>(-1));
  EXPECT_THAT(found.groups, IsEmpty());
  for (const int fd : ends) close(fd);
}

TEST(Credentials, AnAccountIsNamedByTheComputersFiles) {
  EXPECT_EQ(AccountName(0), "root");
  EXPECT_EQ(AccountName(987'654), "uid 987654");
  EXPECT_EQ(GroupNumber("root"), 0u);
  EXPECT_EQ(GroupNumber("no-such-group"), std::nullopt);
}

}  // namespace
}  // namespace flexarm
