#include "controller/files/external_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <cstring>

#include "controller/files/input_error.h"
#include "tests/controller/files/file_folder.h"
#include "tests/support/message_of.h"

namespace flexarm {
namespace {

using testing::EndsWith;
using testing::HasSubstr;

std::string RefusalOf(const std::filesystem::path& file, const FileKind& kind = kConfigFile) {
  return MessageOf<InputError>([&] { ReadExternalText(file, kind); });
}

TEST(ExternalFile, TextIsReadWholeWithoutMarkAndWithPlainLineEnds) {
  const FileFolder folder;
  EXPECT_EQ(ReadExternalText(folder.Put("a", "x = 1\n# \xC3\xA4\n"), kConfigFile),
            "x = 1\n# \xC3\xA4\n");
  EXPECT_EQ(ReadExternalText(folder.Put("b", "\xEF\xBB\xBFx\r\ny\rz\r\n"), kConfigFile),
            "x\ny\nz\n");
  EXPECT_EQ(ReadExternalText(folder.Put("c", ""), kConfigFile), "");
}

TEST(ExternalFile, AMissingFileIsToldApartFromOneThatCannotBeRead) {
  const FileFolder folder;
  const FileContent content = ReadExternalFile(folder / "no", kGainsFile);
  ASSERT_TRUE(content.problem);
  EXPECT_TRUE(content.problem->missing);
  EXPECT_THAT(RefusalOf(folder / "no", kGainsFile),
              EndsWith("no: cannot be read: No such file or directory; expected a gains file"));
  folder.Put("file", "");
  EXPECT_FALSE(ReadExternalFile(folder / "file/below", kGainsFile).problem->missing);
}

TEST(ExternalFile, WhatIsNoRegularFileIsRefusedByItsNameAtOnce) {
  const FileFolder folder;
  EXPECT_THAT(RefusalOf(folder / ""), EndsWith("is a directory; expected a TOML file"));
  ASSERT_EQ(::mkfifo((folder / "fifo").c_str(), 0600), 0);
  EXPECT_THAT(RefusalOf(folder / "fifo"), EndsWith("is a FIFO; expected a TOML file"));
  EXPECT_THAT(RefusalOf("/dev/zero"), EndsWith("is a device; expected a TOML file"));
  std::filesystem::create_symlink("/dev/zero", folder / "link");
  EXPECT_THAT(RefusalOf(folder / "link"), EndsWith("is a device; expected a TOML file"));
  const int fd = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string path = (folder / "s").string();
  ASSERT_LT(path.size(), sizeof(address.sun_path));
  std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
  ASSERT_EQ(::bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  EXPECT_THAT(RefusalOf(folder / "s"), EndsWith("is a socket; expected a TOML file"));
  ::close(fd);
  EXPECT_THAT(ProblemOfPlace(folder / "fifo", "a run log")->Text("f"),
              "f: is a FIFO; expected a run log");
}

TEST(ExternalFile, AFileLargerThanItsKindIsRefused) {
  const FileFolder folder;
  const std::filesystem::path file = folder.Put("f", std::string(kMiB, '#'));
  EXPECT_EQ(ReadExternalText(file, kConfigFile).size(), kMiB);
  std::filesystem::resize_file(file, 300 * kMiB);  // sparse
  EXPECT_THAT(RefusalOf(file), EndsWith("is larger than 1 MiB; expected a TOML file"));
  EXPECT_THAT(RefusalOf(file, kTrajectoryFile), HasSubstr("is larger than 512 KiB"));
  EXPECT_THAT(RefusalOf(file, kCsvFile), HasSubstr("is larger than 256 MiB"));
}

TEST(ExternalFile, BytesThatAreNoTextAreRefusedWithTheirLine) {
  const FileFolder folder;
  EXPECT_THAT(RefusalOf(folder.Put("f", "a\n\nb\xFFz")),
              EndsWith("f:3: found the byte \\xff, which is not UTF-8; expected text in UTF-8"));
  EXPECT_THAT(RefusalOf(folder.Put("f", "a\n\x1B[31m")),
              EndsWith("f:2: found the control character \\x1b; expected text"));
  EXPECT_THAT(RefusalOf(folder.Put("f", std::string("a\0b", 3))), HasSubstr("\\x00"));
  EXPECT_THAT(RefusalOf(folder.Put("f", "\xFF\xFEx")), HasSubstr(":1: found the byte \\xff"));
}

TEST(ExternalFile, DeepNestingIsRefusedWithItsLine) {
  const FileFolder folder;
  const std::string deep = "\n" + std::string(40'000, '[');
  EXPECT_THAT(RefusalOf(folder.Put("f", deep), kCalibrationFile),
              EndsWith("f:2: is nested more than 32 levels deep; expected a calibration"));
  EXPECT_THAT(RefusalOf(folder.Put("f", "a =" + deep)), HasSubstr("f:2: is nested"));
  EXPECT_EQ(ReadExternalText(folder.Put("f", deep), kCsvFile), deep) << "CSV has no brackets";
}

TEST(ExternalFile, ANameIsPrintedWithoutItsControlCharacters) {
  const FileFolder folder;
  EXPECT_THAT(RefusalOf(folder / "a\x1B[2Jb"), HasSubstr("a\\x1b[2Jb: cannot be read"));
}

TEST(ExternalFile, TheBeginningOfAFileIsReadWithoutWaiting) {
  const FileFolder folder;
  EXPECT_EQ(Beginning(folder.Put("f", "abcdef"), 4), "abcd");
  EXPECT_EQ(Beginning(folder.Put("f", "ab"), 4), "ab");
  ASSERT_EQ(::mkfifo((folder / "fifo").c_str(), 0600), 0);
  EXPECT_EQ(Beginning(folder / "fifo", 4), "");
}

}  // namespace
}  // namespace flexarm
