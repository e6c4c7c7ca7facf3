#include "tools/status/reply.h"

#include <gtest/gtest.h>

namespace flexarm {
namespace {

// A daemon of another version, or another program on the socket, sends what it likes.
TEST(Reply, ATextIsOneLineThatATerminalDoesNotObey) {
  EXPECT_EQ(TextOf(Reply("limits:\n- one\n- two")), "limits: - one - two");
  EXPECT_EQ(TextOf(Reply("\x1b[2J\r\t\x7f")), "?[2J???");
  EXPECT_EQ(TextOf(Reply("\u009b2J")), "??2J");
  EXPECT_EQ(TextOf(Reply(std::string(500, 'a'))).size(), 402U);
}

}  // namespace
}  // namespace flexarm
