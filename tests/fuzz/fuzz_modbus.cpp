#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <stdexcept>
#include <vector>

#include "hal/modbus/modbus_device.h"
#include "tests/fuzz/fuzz_reader.h"
#include "tests/fuzz/fuzz_targets.h"
#include "tests/hal/modbus/modbus_testing.h"
#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

// A free port of the loopback, for the whole process.
class Listener {
 public:
  Listener() : fd_(socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    auto* place = reinterpret_cast<sockaddr*>(&address);
    if (bind(fd_, place, size) != 0 || listen(fd_, 16) != 0 ||
        getsockname(fd_, place, &size) != 0) {
      throw std::runtime_error("no port of the loopback");
    }
    port_ = ntohs(address.sin_port);
  }
  int port() const { return port_; }
  /// -1: no connection waits.
  int Accept() const { return accept4(fd_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC); }

 private:
  int fd_;
  int port_ = 0;
};

// Answers the driver's requests with bytes of the input, on the driver's own thread: the driver
// reads its clock twice between dropping old bytes and sending a request, and once behind the
// reply. The answer to a request is sent at the second of the three.
class Peer {
 public:
  Peer(const Listener& listener, FuzzReader* from) : listener_(listener), from_(from) {}
  ~Peer() { HangUp(); }
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;

  void BeginExchange() { phase_ = 0; }

  std::int64_t Clock() noexcept {
    now_ns_ += kMs;
    if (const int fd = listener_.Accept(); fd >= 0) {
      HangUp();
      fd_ = fd;
      phase_ = 0;
    } else if (phase_ = (phase_ + 1) % 3; phase_ == 2) {
      Answer();
    }
    return now_ns_;
  }

 private:
  // The connection is reset: one that is closed would keep its port for a minute.
  void HangUp() {
    const linger reset{.l_onoff = 1, .l_linger = 0};
    if (fd_ < 0) return;
    setsockopt(fd_, SOL_SOCKET, SO_LINGER, &reset, sizeof(reset));
    close(fd_);
    fd_ = -1;
  }

  void Answer() {
    ++transaction_;
    const std::uint8_t how = from_->Byte();
    if (how >= 0xF8) return HangUp();
    if (how >= 0xF0) return;  // no answer
    const FuzzBytes body = from_->Take(from_->Byte());
    std::vector<std::uint8_t> reply;
    if (how < 0xC0) {  // the right header for it
      const std::size_t length = body.size() + 1;
      reply = {High(transaction_), Low(transaction_), 0, 0, High(length), Low(length), 1};
    }
    reply.insert(reply.end(), body.begin(), body.end());
    if (how >= 0x80 && how < 0xC0) reply[how % 7U] ^= from_->Byte();
    if (fd_ >= 0) static_cast<void>(send(fd_, reply.data(), reply.size(), MSG_NOSIGNAL));
  }

  static std::uint8_t High(std::size_t n) { return static_cast<std::uint8_t>(n >> 8U); }
  static std::uint8_t Low(std::size_t n) { return static_cast<std::uint8_t>(n & 0xFFU); }

  const Listener& listener_;
  FuzzReader* from_;
  int fd_ = -1;
  int phase_ = 0;
  std::size_t transaction_ = 0;
  std::int64_t now_ns_ = kMs;
};

Peer* the_peer = nullptr;  // of the input: the driver's clock is a plain function

// Two integers, a float and a line in three requests, which 0.5 ms bound each.
ModbusDeviceConfig DeviceAt(int port) {
  ModbusDeviceConfig config = Amplifier();
  config.port = port;
  config.response_timeout_ms = 0.5;
  config.map.push_back(StrainRow(10, 40, ModbusType::kFloat32, ModbusWordOrder::kLittle));
  config.map.back().scale = 1e3;
  config.map.push_back(StrainRow(11, 42, ModbusType::kInt32));
  return config;
}

void Drive(FuzzReader* from, Peer* peer, ModbusDevice* device) {
  SensorFrame frame{};
  constexpr int kMostExchanges = 20;
  for (int i = 0; i < kMostExchanges && !from->empty(); ++i) {
    peer->BeginExchange();
    const BusStatus status = device->Exchange(kDrivesOff, &frame);
    device->counter_values();
    if (status != BusStatus::kOk) device->FaultText(device->FaultOf(status));
    if (status == BusStatus::kDisconnected) static_cast<void>(device->Reconnect());
  }
}

}  // namespace

void FuzzModbus(FuzzBytes input) {
  static const Listener listener;
  FuzzReader from(input);
  Peer peer(listener, &from);
  the_peer = &peer;
  ModbusDevice device(DeviceAt(listener.port()), []() noexcept { return the_peer->Clock(); });
  try {
    device.Open();
    Drive(&from, &peer, &device);
  } catch (const HalError&) {
  }
}

}  // namespace flexarm
