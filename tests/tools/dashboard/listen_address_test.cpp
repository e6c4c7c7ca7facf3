#include "tools/dashboard/listen_address.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "controller/files/input_error.h"
#include "tests/support/message_of.h"

namespace flexarm {
namespace {

using testing::HasSubstr;

bool IsLoopback(const char* ip) { return ListenAddress{.ip = ip, .port = 1}.IsLoopback(); }

TEST(ListenAddress, KnowsWhatOnlyThisComputerReaches) {
  EXPECT_TRUE(IsLoopback("127.0.0.1"));
  EXPECT_TRUE(IsLoopback("127.8.9.10"));
  EXPECT_TRUE(IsLoopback("::1"));
  EXPECT_FALSE(IsLoopback("128.0.0.1"));
  EXPECT_FALSE(IsLoopback("192.0.2.7"));
  EXPECT_FALSE(IsLoopback("::2"));
  EXPECT_FALSE(IsLoopback("::ffff:127.0.0.1"));  // not an address of the loopback interface
}

TEST(ListenAddress, RefusesAllAddressesAtOnceAndWhatIsNone) {
  for (const char* ip : {"0.0.0.0", "::"}) {
    EXPECT_THAT(MessageOf<InputError>([ip] { IsLoopback(ip); }), HasSubstr("every address")) << ip;
  }
  for (const char* ip : {"", "localhost", "127.1", "127.0.0.1:80", "[::1]", "256.0.0.1"}) {
    EXPECT_THAT(MessageOf<InputError>([ip] { IsLoopback(ip); }), HasSubstr("is no address")) << ip;
  }
}

TEST(ListenAddress, IsWrittenAsInAUrl) {
  EXPECT_EQ((ListenAddress{.ip = "127.0.0.1", .port = 80}.Text()), "127.0.0.1:80");
  EXPECT_EQ((ListenAddress{.ip = "::1", .port = 8080}.Text()), "[::1]:8080");
}

TEST(ListenAddress, APortThatIsTakenIsToldWithWhatToDo) {
  ListenAddress free{.ip = "127.0.0.1", .port = 0};
  const FileDescriptor first = Listen(&free);
  EXPECT_GT(free.port, 0);
  ListenAddress same = free;
  EXPECT_THAT(MessageOf<InputError>([&] { Listen(&same); }), HasSubstr("--port"));
}

}  // namespace
}  // namespace flexarm
