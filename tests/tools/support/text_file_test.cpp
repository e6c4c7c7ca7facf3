#include "tools/support/text_file.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "controller/runlog/errors.h"
#include "tests/config/config_testing.h"
#include "tests/support/message_of.h"

namespace flexarm {
namespace {

TEST(WriteText, ReplacesAnExistingFile) {
  const TempFolder folder;
  const std::filesystem::path file = folder.Write("page.md", "a longer text\n");
  WriteText(file, "short\n");
  EXPECT_EQ(FileText(file), "short\n");
}

TEST(WriteText, NamesTheFileThatCannotBeWritten) {
  EXPECT_EQ(MessageOf<InputError>([] { WriteText("/no/such/folder/page.md", "text"); }),
            "/no/such/folder/page.md: cannot be written");
}

}  // namespace
}  // namespace flexarm
