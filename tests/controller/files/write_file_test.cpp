#include "controller/files/write_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <csignal>

#include "controller/files/input_error.h"
#include "tests/controller/files/file_folder.h"
#include "tests/support/message_of.h"

namespace flexarm {
namespace {

using testing::EndsWith;
using testing::HasSubstr;

const OutputRules kRules{.kind = "a gains file", .mark = "MARK", .inputs = {}, .overwrite = false};

OutputRules Overwriting() {
  OutputRules rules = kRules;
  rules.overwrite = true;
  return rules;
}

std::string OutputRefusal(const std::filesystem::path& file, const OutputRules& rules = kRules) {
  return MessageOf<InputError>([&] { WriteFile(file, "new", rules); });
}

TEST(WriteFile, ANewFileIsWrittenAndNothingElseIsLeft) {
  const FileFolder folder;
  WriteFile(folder / "f", "MARK text", kRules);
  EXPECT_EQ(folder.Text("f"), "MARK text");
  EXPECT_EQ(folder.Count(), 1);
}

TEST(WriteFile, AFileOfTheSameKindIsReplaced) {
  const FileFolder folder;
  WriteFile(folder / "f", "MARK 1", kRules);
  WriteFile(folder / "f", "MARK 2", kRules);
  EXPECT_EQ(folder.Text("f"), "MARK 2");
}

TEST(WriteFile, AnyOtherFileNeedsToBeAskedFor) {
  const FileFolder folder;
  folder.Put("f", "a thesis");
  EXPECT_THAT(
      OutputRefusal(folder / "f"),
      EndsWith("f: exists and is not a gains file that flexarm wrote; name another file, or "
               "add --overwrite"));
  EXPECT_EQ(folder.Text("f"), "a thesis");
  OutputRules unmarked = kRules;
  unmarked.mark.clear();
  EXPECT_THAT(OutputRefusal(folder / "f", unmarked), HasSubstr("--overwrite"));
  WriteFile(folder / "f", "new", Overwriting());
  EXPECT_EQ(folder.Text("f"), "new");
}

TEST(WriteFile, AnInputIsNeverWrittenUnderAnyOfItsNames) {
  const FileFolder folder;
  OutputRules rules = Overwriting();
  rules.inputs = {folder / "missing", folder.Put("in", "MARK in")};
  std::filesystem::create_hard_link(folder / "in", folder / "hard");
  std::filesystem::create_symlink("in", folder / "soft");
  for (const char* name : {"in", "./in", "hard", "soft"}) {
    EXPECT_THAT(OutputRefusal(folder / name, rules), HasSubstr("is an input of this command"))
        << name;
  }
  EXPECT_EQ(folder.Text("in"), "MARK in");
}

TEST(WriteFile, WhatIsNoRegularFileIsNeverReplaced) {
  const FileFolder folder;
  EXPECT_THAT(OutputRefusal("/dev/null", Overwriting()), HasSubstr("/dev/null: is a device"));
  ASSERT_EQ(::mkfifo((folder / "fifo").c_str(), 0600), 0);
  EXPECT_THAT(OutputRefusal(folder / "fifo", Overwriting()), HasSubstr("is a FIFO"));
  std::filesystem::create_directory(folder / "d");
  EXPECT_THAT(OutputRefusal(folder / "d", Overwriting()), HasSubstr("is a directory"));
  EXPECT_THAT(OutputRefusal(folder / "", Overwriting()), HasSubstr("the name of a file"));
}

TEST(WriteFile, TheCauseOfAFailureIsTold) {
  const FileFolder folder;
  EXPECT_THAT(OutputRefusal(folder / "no/f"),
              HasSubstr("cannot be written: No such file or directory"));
  folder.Put("file", "");
  EXPECT_THAT(OutputRefusal(folder / "file/f"), HasSubstr("Not a directory"));
  EXPECT_THAT(OutputRefusal(folder / std::string(400, 'x')), HasSubstr("File name too long"));
  std::filesystem::create_symlink("nowhere", folder / "dangling");
  EXPECT_THAT(OutputRefusal(folder / "dangling"), HasSubstr("a link that leads nowhere"));
  EXPECT_THAT(MessageOf<InputError>([&] { MakeFolder(folder / "file"); }),
              HasSubstr("file: cannot be made a folder"));
}

TEST(WriteFile, ALinkAndThePermissionsStay) {
  const FileFolder folder;
  folder.Put("real", "MARK");
  ASSERT_EQ(::chmod((folder / "real").c_str(), 0600), 0);
  std::filesystem::create_symlink("real", folder / "link");
  WriteFile(folder / "link", "MARK new", kRules);
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
  EXPECT_EQ(folder.Text("real"), "MARK new");
  struct stat there{};
  ASSERT_EQ(::stat((folder / "real").c_str(), &there), 0);
  EXPECT_EQ(there.st_mode & 0777U, 0600U);
  EXPECT_EQ(folder.Count(), 2);
}

TEST(WriteFile, AFailureHalfWayLeavesTheOldFileAndNothingElse) {
  const FileFolder folder;
  WriteFile(folder / "f", "MARK old", kRules);
  const pid_t child = fork();
  if (child == 0) {  // no file of this process may have more than 4 KiB
    const rlimit limit{.rlim_cur = 4096, .rlim_max = 4096};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    std::signal(SIGXFSZ, SIG_IGN);
    try {
      WriteFile(folder / "f", std::string(100'000, 'x'), kRules);
    } catch (const InputError& error) {
      _exit(std::string(error.what()).find("File too large") != std::string::npos ? 42 : 1);
    }
    _exit(0);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(WEXITSTATUS(status), 42);
  EXPECT_EQ(folder.Text("f"), "MARK old");
  EXPECT_EQ(folder.Count(), 1);
}

TEST(WriteFile, AFolderWithFilesNeedsToBeAskedFor) {
  const FileFolder folder;
  MakeOutputFolder(folder / "new/below", false);
  MakeOutputFolder(folder / "new/below", false);
  folder.Put("new/below/f", "x");
  EXPECT_THAT(MessageOf<InputError>([&] { MakeOutputFolder(folder / "new/below", false); }),
              HasSubstr("is a folder with files"));
  EXPECT_NO_THROW(MakeOutputFolder(folder / "new/below", true));
  EXPECT_EQ(folder.Text("new/below/f"), "x");
}

TEST(WriteFile, APlaceCanBeCheckedBeforeTheWork) {
  const FileFolder folder;
  EXPECT_NO_THROW(CheckOutput(folder / "f", kRules));
  EXPECT_EQ(folder.Count(), 0);
  EXPECT_THROW(CheckOutput(folder / "no/f", kRules), InputError);
  EXPECT_THROW(CheckOutput(folder.Put("g", "x"), kRules), InputError);
}

}  // namespace
}  // namespace flexarm
