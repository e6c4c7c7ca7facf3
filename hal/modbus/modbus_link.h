#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "hal/bus_device.h"
#include "hal/modbus/modbus_config.h"
#include "hal/modbus/modbus_plan.h"

namespace flexarm {

/// CLOCK_MONOTONIC in ns; comes from outside, as only executors read clocks.
using ModbusClock = std::int64_t (*)() noexcept;

/// What a link has met since it was made.
struct ModbusCounters {
  std::uint64_t connects;       ///< attempts to connect
  std::uint64_t requests;       ///< sent
  std::uint64_t timeouts;       ///< no reply, or not all of it, in time
  std::uint64_t mismatches;     ///< bytes that are no reply to the request
  std::uint64_t exceptions;     ///< the device refused a request
  std::uint64_t late_bytes;     ///< dropped: of replies that came after their time-out
  std::uint64_t stale_dropped;  ///< requests not sent because earlier ones do not leave
  std::uint64_t lost_links;     ///< closed by the peer, by the kernel, or after two mismatches
  int last_exception;           ///< code that the last reply refused with, 0: it did not
};

/// What a reply carries.
struct ModbusReply {
  std::array<std::uint8_t, 250> payload;
  std::int64_t middle_ns;  ///< half-way between request and reply: when it was true

  /// The i-th register asked for.
  std::uint16_t Word(int i) const noexcept;
  /// The i-th bit asked for.
  bool Bit(int i) const noexcept;
};

/// One connection, TCP or serial, to one unit: sends a request, waits for its reply and lets
/// nothing else pass.
///
/// libmodbus connects, frames and times; the replies are judged here, because it does not compare
/// the unit and the length of a TCP reply, and does not tell a late reply from a broken one.
/// Against what bites (each with a test in tests/hal/modbus/hostile_peer_test.cpp):
/// - A late reply would make every later one late: whatever has arrived is thrown away before each
///   request, transaction numbers are compared, and two mismatches without a good exchange between
///   them are a lost link. (modbus_flush itself reads for as long as a flooding peer sends: over
///   TCP, this reads a bounded number of bytes.)
/// - The byte time-out of libmodbus restarts with every byte: it is 0, so one time-out bounds the
///   whole reply.
/// - Its error recovery sleeps and loops: it is off.
/// - A pulled cable lets requests pile up and burst later: at most four wait for acknowledgement,
///   and the kernel gives a connection up that acknowledges nothing for 250 ms.
/// - Serial adapters hold bytes back: see serial_latency.h.
///
/// Real-time: Ask is bounded by the request's worst_ns; nothing after the constructor allocates.
/// Thread: one.
class ModbusLink {
 public:
  /// @param config  without problems; outlives the link
  ModbusLink(const ModbusDeviceConfig& config, ModbusClock clock);
  ~ModbusLink();
  ModbusLink(const ModbusLink&) = delete;
  ModbusLink& operator=(const ModbusLink&) = delete;

  /// Connects and reads every setting back; at most the response time-out. See failure().
  [[nodiscard]] BusStatus Connect() noexcept;

  [[nodiscard]] BusStatus Ask(const ModbusRequest& request, ModbusReply* reply) noexcept;

  /// All of an exchange was right: mismatches before it no longer count. One right reply is not
  /// enough: a serial peer that is late for ever gives those too.
  void ForgiveMismatches() noexcept { mismatches_in_a_row_ = 0; }

  void Close() noexcept;

  bool is_open() const noexcept { return open_; }
  const ModbusCounters& counters() const noexcept { return counters_; }

  /// What the last failing Connect met, and its errno or 0.
  struct Failure {
    const char* what;
    int error;
  };
  const Failure& failure() const noexcept { return failure_; }

 private:
  struct Context;

  bool rtu() const noexcept { return config_.transport == ModbusTransport::kRtu; }
  BusStatus Fail(const char* what, int error) noexcept;
  BusStatus SetUpTcp() noexcept;
  BusStatus SetUpSerial() noexcept;
  BusStatus Drain() noexcept;
  BusStatus JudgeDrained(int bytes) noexcept;
  void WaitForSilence(std::int64_t silent_ns) noexcept;
  bool RequestsLeave() noexcept;
  bool Send(const ModbusRequest& request) noexcept;
  BusStatus Receive(const ModbusRequest& request, ModbusReply* reply) noexcept;
  BusStatus Mismatch() noexcept;
  BusStatus Lost() noexcept;

  const ModbusDeviceConfig& config_;
  ModbusClock clock_;
  std::unique_ptr<Context> context_;
  int fd_ = -1;
  bool open_ = false;
  bool in_step_ = true;  // every request so far was answered: bytes before the next are unexpected
  int mismatches_in_a_row_ = 0;
  std::uint16_t transaction_ = 0;
  std::int64_t last_traffic_ns_ = 0;
  ModbusCounters counters_{};
  Failure failure_{.what = "", .error = 0};
};

}  // namespace flexarm
