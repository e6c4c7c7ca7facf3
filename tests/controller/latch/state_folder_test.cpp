#include "controller/latch/state_folder.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <functional>

#include "controller/types/rejected_error.h"
#include "tests/controller/latch/latch_folder.h"
#include "tests/controller/latch/sync_calls.h"
#include "tests/support/message_of.h"

namespace flexarm {
namespace {

using testing::HasSubstr;

constexpr const char* kName = "file.json";
constexpr const char* kPart = "file.json.part";

struct StateFolderTest : testing::Test {
  LatchFolder there;
};

// Status of a child process that runs `body`; it exits with what `body` returns.
int InChild(const std::function<int()>& body) {
  const pid_t child = fork();
  if (child == 0) _exit(body());
  int status = 0;
  EXPECT_EQ(waitpid(child, &status, 0), child);
  return status;
}

// The same by a user without rights.
int AsNobody(const std::function<int()>& body) {
  return InChild([&] {
    constexpr uid_t kNobody = 65534;
    if (geteuid() == 0 && (setgid(kNobody) != 0 || setuid(kNobody) != 0)) return 2;
    return body();
  });
}

TEST_F(StateFolderTest, WhatWasWrittenIsReadByTheNext) {
  {
    const StateFolder folder(there.path());
    EXPECT_FALSE(folder.Read(kName).text);
    EXPECT_EQ(folder.Read(kName).problem, "");
    EXPECT_EQ(folder.Replace(kName, "first").problem, "");
    EXPECT_EQ(folder.Replace(kName, "second").problem, "");
  }
  const StateFolder next(there.path());
  EXPECT_EQ(next.Read(kName).text, "second");
  EXPECT_FALSE(there.Has(kPart));
  EXPECT_EQ(next.Remove(kName).problem, "");
  EXPECT_FALSE(next.Read(kName).text);
  EXPECT_EQ(next.Remove(kName).problem, "") << "nothing is there to remove";
}

TEST_F(StateFolderTest, ASecondDaemonIsRefusedWhileTheFirstRuns) {
  auto first = std::make_unique<StateFolder>(there.path());
  EXPECT_THAT(MessageOf<RejectedError>([&] { const StateFolder second(there.path()); }),
              HasSubstr("belongs to a daemon that runs"));
  first.reset();
  EXPECT_NO_THROW(StateFolder(there.path()));
}

TEST_F(StateFolderTest, AKilledDaemonLeavesNoLock) {
  const int status = InChild([&] {
    const StateFolder folder(there.path());
    raise(SIGKILL);
    return 0;
  });
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_NO_THROW(StateFolder(there.path()));
}

TEST_F(StateFolderTest, AFolderThatCannotBeMadeIsRefusedWithTheRemedy) {
  there.Put("plain", "");
  const auto below = there.file("plain") / "state";
  EXPECT_THAT(MessageOf<RejectedError>([&] { const StateFolder folder(below); }),
              testing::AllOf(HasSubstr("cannot be created"), HasSubstr("daemon.state_directory")));
  EXPECT_THAT(MessageOf<RejectedError>([&] { const StateFolder folder(there.file("plain")); }),
              HasSubstr("daemon.state_directory"));
}

TEST_F(StateFolderTest, WhatIsNoPlainFileIsAProblemAndNeverMissing) {
  there.Put("elsewhere", "text");
  const StateFolder folder(there.path());
  std::filesystem::create_directory(there.file(kName));
  EXPECT_THAT(folder.Read(kName).problem, HasSubstr(kName));
  std::filesystem::remove(there.file(kName));
  std::filesystem::create_symlink("elsewhere", there.file(kName));
  EXPECT_THAT(folder.Read(kName).problem, HasSubstr(kName));
  std::filesystem::remove(there.file(kName));
  std::filesystem::create_symlink("nowhere", there.file(kName));
  EXPECT_NE(folder.Read(kName).problem, "") << "a link to nothing";
  std::filesystem::remove(there.file(kName));
  ASSERT_EQ(mkfifo(there.file(kName).c_str(), 0600), 0);
  EXPECT_NE(folder.Read(kName).problem, "") << "does not hang";
  std::filesystem::remove(there.file(kName));
  there.Put(kName, std::string(1'000'000, 'x'));
  EXPECT_THAT(folder.Read(kName).problem, HasSubstr("larger"));
  EXPECT_FALSE(folder.Read(kName).text);
}

TEST_F(StateFolderTest, AFileWithoutPermissionIsAProblem) {
  there.Put(kName, "text");
  std::filesystem::permissions(there.file(kName), std::filesystem::perms::none);
  std::filesystem::permissions(there.path().parent_path(), std::filesystem::perms::all);
  const int status = AsNobody([&] {
    const FileText found = StateFolder(there.path()).Read(kName);
    const bool named = found.problem.find("Permission denied") != std::string::npos;
    return !found.text && named ? 0 : 1;
  });
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_TRUE(WIFEXITED(status));
}

TEST_F(StateFolderTest, AFolderWithoutPermissionIsRefusedWithTheRemedy) {
  std::filesystem::create_directories(there.path());
  std::filesystem::permissions(there.path(), std::filesystem::perms::none);
  std::filesystem::permissions(there.path().parent_path(), std::filesystem::perms::all);
  const int status = AsNobody([&] {
    const std::string refusal =
        MessageOf<RejectedError>([&] { const StateFolder folder(there.path()); });
    return refusal.find("cannot be opened: Permission denied") != std::string::npos &&
                   refusal.find("daemon.state_directory") != std::string::npos
               ? 0
               : 1;
  });
  std::filesystem::permissions(there.path(), std::filesystem::perms::owner_all);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

TEST_F(StateFolderTest, AFullDiskLeavesTheOldFile) {
  const StateFolder folder(there.path());
  {
    const FullDisk full;
    const FileChange change = folder.Replace(kName, "new");
    EXPECT_THAT(change.problem, HasSubstr(kName));
    EXPECT_TRUE(change.untouched);
  }
  EXPECT_FALSE(folder.Read(kName).text);
  EXPECT_EQ(folder.Read(kName).problem, "") << "it cleans up";
  ASSERT_EQ(folder.Replace(kName, "old").problem, "");
  {
    const FullDisk full;
    EXPECT_TRUE(folder.Replace(kName, "new").untouched);
    EXPECT_EQ(folder.Read(kName).text, "old");
    EXPECT_EQ(folder.Remove(kName).problem, "") << "needs no room";
  }
}

// The kernel kills a process that writes beyond RLIMIT_FSIZE: here after a part of the text.
TEST_F(StateFolderTest, AProcessKilledInTheMiddleOfAWriteLeavesTheOldFile) {
  const auto killed_while_writing = [&] {
    const int status = InChild([&] {
      const StateFolder folder(there.path());
      const rlimit few{.rlim_cur = 3, .rlim_max = 3};
      const rlimit no_core{.rlim_cur = 0, .rlim_max = 0};
      setrlimit(RLIMIT_CORE, &no_core);
      setrlimit(RLIMIT_FSIZE, &few);
      return folder.Replace(kName, "new text").problem.empty() ? 0 : 1;
    });
    return WIFSIGNALED(status) && WTERMSIG(status) == SIGXFSZ;
  };
  ASSERT_TRUE(killed_while_writing());
  EXPECT_TRUE(there.Has(kPart));
  {
    const StateFolder folder(there.path());
    EXPECT_THAT(folder.Read(kName).problem, HasSubstr("interrupted"))
        << "whether there was a file is not known";
    ASSERT_EQ(folder.Replace(kName, "old").problem, "");
  }
  ASSERT_TRUE(killed_while_writing());
  const StateFolder folder(there.path());
  EXPECT_EQ(folder.Read(kName).text, "old");
  errno = EIO;  // of an earlier call
  EXPECT_EQ(folder.Remove(kName).problem, "");
  EXPECT_EQ(folder.Read(kName).problem, "") << "the part is removed too";
}

// Its entry in the folder above.
TEST_F(StateFolderTest, AFolderThatIsNewIsSyncedSoThatAPowerFailureKeepsIt) {
  file_systems_synced = 0;
  {
    const StateFolder made(there.path());
  }
  EXPECT_EQ(file_systems_synced, 1);
  {
    const StateFolder found(there.path());
  }
  EXPECT_EQ(file_systems_synced, 1) << "it was there";
}

TEST_F(StateFolderTest, ARemovalThatIsNotSyncedIsAProblem) {
  const StateFolder folder(there.path());
  ASSERT_EQ(folder.Replace(kName, "text").problem, "");
  const FoldersFailToSync failing;
  const FileChange change = folder.Remove(kName);
  EXPECT_THAT(change.problem, HasSubstr(kName));
  EXPECT_FALSE(change.untouched);
}

// How many descriptors of this process are of something in the folder, or of the folder.
int OpenIn(const std::filesystem::path& folder, bool only_inherited = false) {
  int count = 0;
  for (int fd = 0; fd < 256; ++fd) {
    std::error_code closed;
    const auto target =
        std::filesystem::read_symlink("/proc/self/fd/" + std::to_string(fd), closed);
    if (closed || !target.native().starts_with(folder.native())) continue;
    count += !only_inherited || (fcntl(fd, F_GETFD) & FD_CLOEXEC) == 0;
  }
  return count;
}

TEST_F(StateFolderTest, NothingButTheFolderStaysOpen) {
  there.Put(kName, "text");
  {
    const StateFolder folder(there.path());
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(folder.Read(kName).text, "text");
      EXPECT_THROW(StateFolder(there.path()), RejectedError);
    }
    EXPECT_EQ(OpenIn(there.path()), 1);
    EXPECT_EQ(OpenIn(there.path(), true), 0) << "a program that the daemon starts would lock it";
  }
  EXPECT_EQ(OpenIn(there.path()), 0);
}

// Then the next file that is opened has the descriptor 0.
TEST_F(StateFolderTest, WithoutAStandardInputItIsTheSame) {
  there.Put(kName, "text");
  const int status = InChild([&] {
    close(STDIN_FILENO);
    return StateFolder(there.path()).Read(kName).text == "text" ? 0 : 1;
  });
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
  const StateFolder folder(there.path());
  const int of_file = InChild([&] {
    close(STDIN_FILENO);
    errno = 0;
    return folder.Read(kName).text == "text" ? 0 : 1;
  });
  EXPECT_TRUE(WIFEXITED(of_file));
  EXPECT_EQ(WEXITSTATUS(of_file), 0);
}

TEST_F(StateFolderTest, AFolderThatWasDeletedIsNamed) {
  const StateFolder folder(there.path());
  std::filesystem::remove_all(there.path());
  EXPECT_THAT(folder.Replace(kName, "text").problem, HasSubstr("No such file"));
}

}  // namespace
}  // namespace flexarm
