#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <modbus.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <memory>
#include <vector>

#include "controller/realtime/clock.h"
#include "hal/modbus/modbus_device.h"
#include "tests/hal/modbus/hostile_peer.h"
#include "tests/hal/modbus/modbus_testing.h"
#include "tests/support/message_of.h"

// The installed libmodbus by itself, without ModbusLink: the faults for which ModbusLink has a
// measure, in 3.1.6 (Debian 12) and 3.1.11 (Debian 13). A test that fails with a newer libmodbus
// says that a fault is mended there: then its measure can go when no older one is supported.

namespace flexarm {
namespace {

using enum WireFault;

constexpr int kReadings = 10;  // a reply of 29 bytes
constexpr std::uint32_t kTimeoutUs = 300'000;
constexpr std::uint32_t kLongTimeoutUs =
    900'000;  // where an answer must come: an idle machine was 0.23 s late

class LibmodbusItself : public testing::Test {
 protected:
  void Connect(modbus_error_recovery_mode recovery, std::uint32_t timeout_us = kTimeoutUs) {
    modbus_.reset(modbus_new_tcp("127.0.0.1", peer_.port()));
    modbus_set_slave(modbus_.get(), 1);
    modbus_set_error_recovery(modbus_.get(), recovery);
    modbus_set_response_timeout(modbus_.get(), 0, timeout_us);
    ASSERT_EQ(modbus_connect(modbus_.get()), 0);
  }
  // What modbus_read_input_registers returns, and its errno.
  int Read() {
    errno = 0;
    const std::int64_t begin_ns = MonotonicNow();
    const int count = modbus_read_input_registers(modbus_.get(), 0, kReadings, values_.data());
    took_us_ = (MonotonicNow() - begin_ns) / 1000;
    return count;
  }

  HostilePeer peer_{ModbusTransport::kTcp};
  struct Free {
    void operator()(modbus_t* modbus) const {
      modbus_close(modbus);
      modbus_free(modbus);
    }
  };
  std::unique_ptr<modbus_t, Free> modbus_;
  std::array<std::uint16_t, kReadings> values_{};
  std::int64_t took_us_ = 0;
};

// Upstream's issue 255. ModbusLink drops what waits before each request.
TEST_F(LibmodbusItself, IsOneReplyBehindForEverAfterALateOne) {
  Connect(MODBUS_ERROR_RECOVERY_NONE, kLongTimeoutUs);
  ASSERT_EQ(Read(), kReadings);
  peer_.Behave(kLate);
  EXPECT_EQ(Read(), -1);
  EXPECT_EQ(errno, ETIMEDOUT);
  peer_.ReleaseHeld();
  peer_.Behave(kNone);
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(Read(), -1);
    EXPECT_EQ(errno, EMBBADDATA);
  }
}

// Its byte time-out (0.5 s by default) restarts with each of the bytes, which come every 20 ms.
// ModbusLink sets it to 0: then one time-out bounds the reply.
TEST_F(LibmodbusItself, ExceedsItsTimeoutWhenBytesComeSlowly) {
  peer_.Behave(kByteByByte);
  int count = -1;
  for (int i = 0; i < 20 && count != kReadings; ++i) {  // a loaded machine sends the first one late
    Connect(MODBUS_ERROR_RECOVERY_NONE);
    count = Read();
  }
  EXPECT_EQ(count, kReadings);
  EXPECT_GT(took_us_, kTimeoutUs);
  peer_.Behave(kNone);
}

// ModbusLink leaves it off.
TEST_F(LibmodbusItself, SleepsAnotherTimeoutInItsErrorRecovery) {
  Connect(MODBUS_ERROR_RECOVERY_LINK);
  peer_.Behave(kSilent);
  EXPECT_EQ(Read(), -1);
  EXPECT_GE(took_us_, 2 * kTimeoutUs);
}

// It checks neither unit nor length of a TCP reply. ModbusLink does.
TEST_F(LibmodbusItself, AcceptsTheReplyOfAnotherUnit) {
  Connect(MODBUS_ERROR_RECOVERY_NONE, kLongTimeoutUs);
  peer_.Behave(kWrongUnit);
  EXPECT_EQ(Read(), kReadings);
}

// A listener whose queue is full: the kernel drops the requests to connect.
class FullListener {
 public:
  FullListener() {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    auto* const generic = reinterpret_cast<sockaddr*>(&address);
    EXPECT_EQ(bind(sockets_[0], generic, size), 0);
    EXPECT_EQ(listen(sockets_[0], 0), 0);
    getsockname(sockets_[0], generic, &size);
    port_ = ntohs(address.sin_port);
    for (std::size_t i = 1; i < sockets_.size(); ++i) {
      static_cast<void>(connect(sockets_[i], generic, size));  // the later ones stay under way
    }
  }
  ~FullListener() {
    for (const int socket : sockets_) close(socket);
  }
  FullListener(const FullListener&) = delete;
  FullListener& operator=(const FullListener&) = delete;

  int port() const { return port_; }

 private:
  static int NewSocket() { return socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0); }

  std::vector<int> sockets_ = {NewSocket(), NewSocket(), NewSocket(), NewSocket()};
  int port_ = 0;
};

// Mended in 3.1.11: before, errno is EINPROGRESS after a connection that timed out.
TEST(LibmodbusVersions, AConnectionThatTimesOutIsNamedSoByTheDriverWithEachOfThem) {
  const FullListener listener;
  modbus_t* modbus = modbus_new_tcp("127.0.0.1", listener.port());
  modbus_set_response_timeout(modbus, 0, kTimeoutUs);
  EXPECT_EQ(modbus_connect(modbus), -1);
  EXPECT_EQ(errno, LIBMODBUS_VERSION_CHECK(3, 1, 11) ? ETIMEDOUT : EINPROGRESS);
  modbus_free(modbus);

  ModbusDeviceConfig config = Amplifier();
  config.port = listener.port();
  ModbusDevice device(config, MonotonicNow);
  EXPECT_THAT(MessageOf<HalError>([&] { device.Open(); }),
              testing::HasSubstr("Connection timed out"));
}

}  // namespace
}  // namespace flexarm
