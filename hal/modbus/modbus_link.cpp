#include "hal/modbus/modbus_link.h"

#include <linux/sockios.h>
#include <modbus.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/select.h>
#include <sys/socket.h>
#include <termios.h>

#include <cerrno>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <new>

#include "hal/modbus/serial_latency.h"
#include "hal/time_units.h"

namespace flexarm {
namespace {

// Longer than the kernel's shortest retransmission time-out, 200 ms: one lost packet must not end a
// connection.
constexpr unsigned kUserTimeoutMs = 250;
constexpr int kTcpHeader = 7;  // transaction, protocol, length, unit
constexpr int kTcpRequest = kTcpHeader + 5;
constexpr int kMostWaitingRequests = 4;
constexpr int kSerialHeader = 1;  // unit
constexpr int kMostMismatchesInARow = 2;
constexpr int kMostDrainedFrames = 8;  // more waiting bytes than of this many frames are a flood
constexpr std::uint8_t kExceptionBit = 0x80;

std::uint8_t High(int value) noexcept { return static_cast<std::uint8_t>(value >> 8); }
std::uint8_t Low(int value) noexcept { return static_cast<std::uint8_t>(value & 0xFF); }
int Joined(std::uint8_t high, std::uint8_t low) noexcept { return high << 8 | low; }

int PayloadBytes(const ModbusRequest& request) noexcept {
  return HoldsBits(request.table) ? (request.count + 7) / 8 : 2 * request.count;
}

char ParityLetter(ModbusParity parity) noexcept {
  switch (parity) {
    case ModbusParity::kNone:
      return 'N';
    case ModbusParity::kEven:
      return 'E';
    case ModbusParity::kOdd:
      return 'O';
  }
  return 'N';
}

speed_t SpeedOf(int baud) noexcept {
  switch (baud) {
    case 1200:
      return B1200;
    case 2400:
      return B2400;
    case 4800:
      return B4800;
    case 9600:
      return B9600;
    case 19200:
      return B19200;
    case 38400:
      return B38400;
    case 57600:
      return B57600;
    case 115200:
      return B115200;
    case 230400:
      return B230400;
    default:
      return B0;
  }
}

void SetTimeout(modbus_t* modbus, std::int64_t timeout_ns) noexcept {
  const std::int64_t us = (timeout_ns + 999) / 1000;
  modbus_set_response_timeout(modbus, static_cast<std::uint32_t>(us / 1'000'000),
                              static_cast<std::uint32_t>(us % 1'000'000));
}

}  // namespace

struct ModbusLink::Context {
  explicit Context(const ModbusDeviceConfig& config)
      : modbus(config.transport == ModbusTransport::kTcp
                   ? modbus_new_tcp(config.host.c_str(), config.port)
                   : modbus_new_rtu(config.device.c_str(), config.baud, ParityLetter(config.parity),
                                    config.data_bits, config.stop_bits)) {
    if (modbus == nullptr) throw HalError("modbus '" + config.name + "': " + std::strerror(errno));
  }
  ~Context() { modbus_free(modbus); }
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  modbus_t* modbus;
};

std::uint16_t ModbusReply::Word(int i) const noexcept {
  const std::size_t at = 2 * static_cast<std::size_t>(i);
  return static_cast<std::uint16_t>(Joined(payload[at], payload[at + 1]));
}

bool ModbusReply::Bit(int i) const noexcept {
  const auto bit = static_cast<unsigned>(i);
  return ((unsigned{payload[bit / 8]} >> (bit % 8)) & 1U) != 0;
}

ModbusLink::ModbusLink(const ModbusDeviceConfig& config, ModbusClock clock)
    : config_(config), clock_(clock), context_(std::make_unique<Context>(config)) {
  modbus_t* modbus = context_->modbus;
  modbus_set_slave(modbus, config.unit);
  modbus_set_error_recovery(modbus, MODBUS_ERROR_RECOVERY_NONE);
  modbus_set_byte_timeout(modbus, 0, 0);
}

ModbusLink::~ModbusLink() { Close(); }

BusStatus ModbusLink::Fail(const char* what, int error) noexcept {
  failure_ = {.what = what, .error = error};
  Close();
  return BusStatus::kDisconnected;
}

BusStatus ModbusLink::Connect() noexcept {
  Close();
  ++counters_.connects;
  const auto timeout_ns = static_cast<std::int64_t>(std::ceil(config_.response_timeout_ms * 1e6));
  SetTimeout(context_->modbus, timeout_ns);
  if (modbus_connect(context_->modbus) != 0) {
    const int error = errno == EINPROGRESS ? ETIMEDOUT : errno;  // libmodbus before 3.1.11
    return Fail("cannot connect", error);
  }
  open_ = true;
  fd_ = modbus_get_socket(context_->modbus);
  if (fd_ >= FD_SETSIZE) return Fail("too many open files: libmodbus waits with select", EMFILE);
  in_step_ = true;
  mismatches_in_a_row_ = 0;
  last_traffic_ns_ = clock_();
  return rtu() ? SetUpSerial() : SetUpTcp();
}

BusStatus ModbusLink::SetUpTcp() noexcept {
  const unsigned wanted = kUserTimeoutMs;
  if (setsockopt(fd_, IPPROTO_TCP, TCP_USER_TIMEOUT, &wanted, sizeof(wanted)) != 0) {
    return Fail("the kernel refuses TCP_USER_TIMEOUT", errno);
  }
  unsigned user_timeout_ms = 0;
  socklen_t size = sizeof(user_timeout_ms);
  getsockopt(fd_, IPPROTO_TCP, TCP_USER_TIMEOUT, &user_timeout_ms, &size);
  int no_delay = 0;
  size = sizeof(no_delay);
  getsockopt(fd_, IPPROTO_TCP, TCP_NODELAY, &no_delay, &size);
  if (user_timeout_ms != wanted || no_delay == 0) {
    return Fail("TCP_USER_TIMEOUT or TCP_NODELAY does not read back as set", 0);
  }
  return BusStatus::kOk;
}

BusStatus ModbusLink::SetUpSerial() noexcept {
  termios found{};
  if (tcgetattr(fd_, &found) != 0)
    return Fail("the settings of the serial port cannot be read back", errno);
  const SerialLatency latency = SetLowLatency(fd_, KernelIoctl);
  if (latency == SerialLatency::kRefused) {
    return Fail(
        "the serial adapter does not support the low-latency flag: it may delay replies by "
        "16 ms; use another adapter or port",
        0);
  }
  // A pseudo-terminal has no wire, and does not store the parity bit.
  const tcflag_t parity_kept = latency == SerialLatency::kNoWire ? 0 : PARENB | PARODD;
  tcflag_t parity = config_.parity == ModbusParity::kNone ? 0 : PARENB;
  if (config_.parity == ModbusParity::kOdd) parity |= PARODD;
  const bool as_set = cfgetispeed(&found) == SpeedOf(config_.baud) &&
                      cfgetospeed(&found) == SpeedOf(config_.baud) &&
                      (found.c_cflag & CSIZE) == CS8 &&
                      ((found.c_cflag & CSTOPB) != 0) == (config_.stop_bits == 2) &&
                      (found.c_cflag & parity_kept) == (parity & parity_kept);
  if (!as_set) return Fail("baud rate, parity or stop bits do not read back as set", 0);
  ioctl(fd_, TIOCEXCL);  // exclusive use of the port; pseudo-terminals may ignore it
  return BusStatus::kOk;
}

void ModbusLink::Close() noexcept {
  if (!open_) return;
  open_ = false;
  if (rtu()) modbus_flush(context_->modbus);  // close would wait until all bytes are sent
  modbus_close(context_->modbus);
}

BusStatus ModbusLink::Ask(const ModbusRequest& request, ModbusReply* reply) noexcept {
  if (!open_) return BusStatus::kDisconnected;
  if (const BusStatus drained = Drain(); drained != BusStatus::kOk) return drained;
  WaitForSilence(request.silent_ns);
  if (!RequestsLeave()) {
    ++counters_.stale_dropped;
    in_step_ = false;
    return BusStatus::kTimeout;
  }
  const std::int64_t sent_ns = clock_();
  if (!Send(request)) return Lost();
  ++counters_.requests;
  counters_.last_exception = 0;
  SetTimeout(context_->modbus, request.reply_ns);
  const BusStatus status = Receive(request, reply);
  last_traffic_ns_ = clock_();
  reply->middle_ns = sent_ns + (last_traffic_ns_ - sent_ns) / 2;
  if (status == BusStatus::kOk) in_step_ = true;
  return status;
}

BusStatus ModbusLink::Drain() noexcept {
  if (rtu()) {
    int waiting = 0;
    if (ioctl(fd_, FIONREAD, &waiting) != 0) return Lost();
    if (waiting > 0) {
      last_traffic_ns_ = clock_();
      modbus_flush(context_->modbus);
    }
    if (waiting > kMostDrainedFrames * MODBUS_RTU_MAX_ADU_LENGTH) return Mismatch();
    return JudgeDrained(waiting);
  }
  int bytes = 0;
  for (int i = 0; i < kMostDrainedFrames; ++i) {
    std::array<std::uint8_t, MODBUS_TCP_MAX_ADU_LENGTH> dropped;
    const ssize_t count = recv(fd_, dropped.data(), dropped.size(), MSG_DONTWAIT);
    if (count < 0 && (errno == EAGAIN || errno == EINTR)) return JudgeDrained(bytes);
    if (count <= 0) return Lost();
    bytes += static_cast<int>(count);
  }
  return Mismatch();
}

// After a failure, the rest of a late or broken reply is expected. Otherwise unrequested bytes mean
// that the peer is out of step.
BusStatus ModbusLink::JudgeDrained(int bytes) noexcept {
  if (bytes == 0) return BusStatus::kOk;
  if (in_step_) return Mismatch();
  counters_.late_bytes += static_cast<std::uint64_t>(bytes);
  return BusStatus::kOk;
}

void ModbusLink::WaitForSilence(std::int64_t silent_ns) noexcept {
  const std::int64_t wait_ns = last_traffic_ns_ + silent_ns - clock_();
  if (wait_ns <= 0) return;
  const timespec wait{.tv_sec = wait_ns / kSecondNs, .tv_nsec = wait_ns % kSecondNs};
  ppoll(nullptr, 0, &wait,
        nullptr);  // a signal may end the wait early: the device then misses a frame
}

// Serial: no bytes may wait. TCP: a peer may acknowledge 40 ms late, which is two periods.
bool ModbusLink::RequestsLeave() noexcept {
  int waiting = 0;
  static_assert(SIOCOUTQ == TIOCOUTQ);
  if (ioctl(fd_, SIOCOUTQ, &waiting) != 0) return true;
  return waiting <= (rtu() ? 0 : (kMostWaitingRequests - 1) * kTcpRequest);
}

bool ModbusLink::Send(const ModbusRequest& request) noexcept {
  const std::array<std::uint8_t, 6> body = {
      Low(config_.unit),     Low(static_cast<int>(request.table)),
      High(request.address), Low(request.address),
      High(request.count),   Low(request.count)};
  if (rtu()) {  // libmodbus adds the checksum
    return modbus_send_raw_request(context_->modbus, body.data(), body.size()) > 0;
  }
  // libmodbus gives raw requests no transaction number of their own.
  ++transaction_;
  std::array<std::uint8_t, kTcpRequest> frame = {High(transaction_), Low(transaction_), 0, 0, 0,
                                                 body.size()};
  std::memcpy(frame.data() + 6, body.data(), body.size());
  const ssize_t sent = send(fd_, frame.data(), frame.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  return sent == static_cast<ssize_t>(frame.size());
}

BusStatus ModbusLink::Receive(const ModbusRequest& request, ModbusReply* reply) noexcept {
  std::array<std::uint8_t, MODBUS_MAX_ADU_LENGTH> frame;
  const int length = modbus_receive_confirmation(context_->modbus, frame.data());
  if (length < 0) {
    if (errno == ETIMEDOUT || errno == EAGAIN) {
      ++counters_.timeouts;
      in_step_ = false;
      return BusStatus::kTimeout;
    }
    return errno == EMBBADDATA || errno == EMBBADCRC ? Mismatch() : Lost();
  }
  if (length == 0) return Mismatch();  // serial: a reply of another unit
  const int header = rtu() ? kSerialHeader : kTcpHeader;
  const int tail = rtu() ? 2 : 0;
  if (!rtu()) {
    const bool mine = Joined(frame[0], frame[1]) == transaction_ && frame[2] == 0 &&
                      frame[3] == 0 && Joined(frame[4], frame[5]) == length - 6;
    if (!mine) return Mismatch();
  }
  if (frame[static_cast<std::size_t>(header - 1)] != config_.unit) return Mismatch();
  const auto* body = frame.data() + header;
  const auto function = static_cast<std::uint8_t>(request.table);
  if (body[0] == (function | kExceptionBit) && length == header + 2 + tail) {
    ++counters_.exceptions;
    counters_.last_exception = body[1];
    in_step_ = true;
    return BusStatus::kMalformed;
  }
  const int bytes = PayloadBytes(request);
  if (body[0] != function || body[1] != bytes || length != header + 2 + bytes + tail) {
    return Mismatch();
  }
  std::memcpy(reply->payload.data(), body + 2, static_cast<std::size_t>(bytes));
  return BusStatus::kOk;
}

BusStatus ModbusLink::Mismatch() noexcept {
  ++counters_.mismatches;
  in_step_ = false;
  if (++mismatches_in_a_row_ >= kMostMismatchesInARow) return Lost();
  return BusStatus::kMalformed;
}

BusStatus ModbusLink::Lost() noexcept {
  ++counters_.lost_links;
  Close();
  return BusStatus::kDisconnected;
}

}  // namespace flexarm
