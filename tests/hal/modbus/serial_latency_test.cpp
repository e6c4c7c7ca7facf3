#include "hal/modbus/serial_latency.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/serial.h>
#include <pty.h>
#include <sys/ioctl.h>
#include <unistd.h>

// A simulated adapter: the build machines have none.

namespace flexarm {
namespace {

struct Adapter {
  bool knows_the_flag = true;
  bool keeps_the_flag = true;
  int flags = 0;
};
Adapter adapter;

int AdapterIoctl(int, unsigned long request, void* argument) {
  auto* port = static_cast<serial_struct*>(argument);
  if (!adapter.knows_the_flag) return -1;
  if (request == TIOCGSERIAL) port->flags = adapter.flags;
  if (request == TIOCSSERIAL && adapter.keeps_the_flag) adapter.flags = port->flags;
  return 0;
}

SerialLatency Set(const Adapter& how) {
  adapter = how;
  const int fd = open("/dev/null", O_RDWR | O_CLOEXEC);
  const SerialLatency result = SetLowLatency(fd, AdapterIoctl);
  close(fd);
  return result;
}

constexpr int kSpeedFlag = 0x1000;  // a flag that was set before
constexpr int kLowLatencyFlag = 0x2000;

TEST(SerialLatency, IsSetAndReadBack) {
  EXPECT_EQ(Set({.flags = kSpeedFlag}), SerialLatency::kLow);
  EXPECT_EQ(adapter.flags, kSpeedFlag | kLowLatencyFlag);
}

TEST(SerialLatency, AnAdapterThatDoesNotKeepTheFlagIsRejected) {
  EXPECT_EQ(Set({.keeps_the_flag = false}), SerialLatency::kRefused);
}

TEST(SerialLatency, AnAdapterWithoutTheFlagIsRejected) {
  EXPECT_EQ(Set({.knows_the_flag = false}), SerialLatency::kRefused);
}

TEST(SerialLatency, APseudoTerminalHasNone) {
  int master = -1, slave = -1;
  ASSERT_EQ(openpty(&master, &slave, nullptr, nullptr, nullptr), 0);
  EXPECT_EQ(SetLowLatency(slave, KernelIoctl), SerialLatency::kNoWire);
  close(slave);
  close(master);
}

}  // namespace
}  // namespace flexarm
