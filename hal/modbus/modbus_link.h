#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "hal/bus_device.h"
#include "hal/modbus/modbus_config.h"
#include "hal/modbus/modbus_plan.h"

namespace flexarm {

/// CLOCK_MONOTONIC in ns; injected, as only executors read clocks.
using ModbusClock = std::int64_t (*)() noexcept;

/// Counters of a link since its construction.
struct ModbusCounters {
  std::uint64_t connects;       ///< attempts to connect
  std::uint64_t requests;       ///< sent
  std::uint64_t timeouts;       ///< no reply, or an incomplete one, within the time-out
  std::uint64_t mismatches;     ///< bytes that are not a reply to the request
  std::uint64_t exceptions;     ///< requests answered with an exception
  std::uint64_t late_bytes;     ///< bytes of replies after their time-out, dropped
  std::uint64_t stale_dropped;  ///< requests not sent because earlier ones are not acknowledged
  std::uint64_t lost_links;     ///< closed by the peer, by the kernel, or after two mismatches
  int last_exception;           ///< exception code of the last reply, 0: none
};

/// Content of a reply.
struct ModbusReply {
  std::array<std::uint8_t, 250> payload;
  std::int64_t middle_ns;  ///< half-way between request and reply: time of the values

  /// The i-th requested register.
  std::uint16_t Word(int i) const noexcept;
  /// The i-th requested bit.
  bool Bit(int i) const noexcept;
};

/// One connection, TCP or serial, to one unit: sends a request, waits for its reply and rejects
/// everything else.
///
/// libmodbus connects, frames and times; the replies are checked here, because it does not compare
/// the unit and the length of a TCP reply, and does not distinguish a late reply from a broken one.
/// Measures against known faults (each with a test in tests/hal/modbus/hostile_peer_test.cpp):
/// - One late reply would make all later ones late: received bytes are dropped before each request,
///   transaction numbers are compared, and two mismatches without a good exchange between them are
///   a lost link. (modbus_flush itself reads for as long as a flooding peer sends: over TCP, this
///   reads a bounded number of bytes.)
/// - The byte time-out of libmodbus restarts with every byte: it is 0, so one time-out bounds the
///   whole reply.
/// - Its error recovery sleeps and loops: it is off.
/// - With an unplugged cable requests queue up and are sent in a burst later: at most four wait for
///   acknowledgement, and the kernel closes a connection without acknowledgement for 250 ms.
/// - Serial adapters delay bytes: see serial_latency.h.
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

  /// A whole exchange was right: earlier mismatches no longer count. One right reply is not enough:
  /// a serial peer that is always late gives right replies too.
  void ClearMismatches() noexcept { mismatches_in_a_row_ = 0; }

  void Close() noexcept;

  bool is_open() const noexcept { return open_; }
  const ModbusCounters& counters() const noexcept { return counters_; }

  /// Reason of the last failed Connect, and its errno or 0.
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
  bool in_step_ = true;  // all requests were answered: bytes before the next are unexpected
  int mismatches_in_a_row_ = 0;
  std::uint16_t transaction_ = 0;
  std::int64_t last_traffic_ns_ = 0;
  ModbusCounters counters_{};
  Failure failure_{.what = "", .error = 0};
};

}  // namespace flexarm
