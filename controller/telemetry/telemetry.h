#pragma once

#include <netinet/in.h>

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "controller/exchange/spsc_queue.h"
#include "controller/runlog/file_descriptor.h"
#include "controller/telemetry/telemetry_line.h"
#include "controller/types/telemetry_config.h"

namespace flexarm {

/// Sends samples as UDP datagrams, on a thread of its own: the operator task hands over each sample
/// that it reads anyway, through a bounded queue, and no thread ever waits. What does not fit into
/// the queue or into the socket is lost and counted.
///
/// Not real-time safe, but for Take.
class Telemetry {
 public:
  /// Samples that wait: 5 s at 50 Hz.
  static constexpr std::size_t kDepth = 250;

  /// @param config  valid, with an address
  Telemetry(const TelemetryConfig& config, TelemetrySource source);
  ~Telemetry();
  Telemetry(const Telemetry&) = delete;
  Telemetry& operator=(const Telemetry&) = delete;

  /// Begins to send. Once.
  /// @param epoch_ns  instant 0 of the loop in CLOCK_MONOTONIC
  void Start(std::int64_t epoch_ns);

  /// Operator thread: every sample, in order. Never waits.
  void Take(const TickRecord& tick) noexcept;

  /// Any thread. Part "telemetry" of the status: {address, port, every, sent, lost, error}.
  nlohmann::json Status() const;

 private:
  void Run(const std::stop_token& stop);
  void SendWaiting();
  /// Empty, or why it was not sent.
  std::string Send(const std::string& line);
  bool OpenSocket();

  TelemetryConfig config_;
  TelemetrySource source_;
  sockaddr_storage receiver_{};
  socklen_t receiver_size_ = 0;
  std::int64_t epoch_ns_ = 0;
  SpscQueue<TickRecord> waiting_{kDepth};
  FileDescriptor socket_;     // of the thread
  mutable std::mutex mutex_;  // of what follows; held for a few instructions
  std::condition_variable_any ended_;
  std::uint64_t sent_ = 0, not_sent_ = 0;
  std::string error_;    // of the last datagram; empty: it was sent
  std::jthread thread_;  // the last member: it uses the others
};

}  // namespace flexarm
