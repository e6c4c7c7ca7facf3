#include "controller/telemetry/telemetry.h"

#include <arpa/inet.h>
#include <pthread.h>
#include <sys/socket.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <utility>

#include "controller/realtime/clock.h"

namespace flexarm {
namespace {

// Between two looks into the queue.
constexpr std::chrono::milliseconds kLook{20};

template <typename Address>
socklen_t Write(const Address& address, sockaddr_storage* out) {
  std::memcpy(out, &address, sizeof address);
  return sizeof address;
}

socklen_t ReceiverOf(const TelemetryConfig& config, sockaddr_storage* out) {
  const auto port = htons(static_cast<std::uint16_t>(config.port));
  sockaddr_in v4{};
  if (inet_pton(AF_INET, config.address.c_str(), &v4.sin_addr) == 1) {
    v4.sin_family = AF_INET;
    v4.sin_port = port;
    return Write(v4, out);
  }
  sockaddr_in6 v6{};
  inet_pton(AF_INET6, config.address.c_str(), &v6.sin6_addr);
  v6.sin6_family = AF_INET6;
  v6.sin6_port = port;
  return Write(v6, out);
}

std::string SystemError() { return std::strerror(errno); }

}  // namespace

Telemetry::Telemetry(const TelemetryConfig& config, TelemetrySource source)
    : config_(config), source_(std::move(source)), receiver_size_(ReceiverOf(config, &receiver_)) {}

Telemetry::~Telemetry() = default;

void Telemetry::Start(std::int64_t epoch_ns) {
  epoch_ns_ = epoch_ns;
  thread_ = std::jthread([this](const std::stop_token& stop) { Run(stop); });
}

void Telemetry::Take(const TickRecord& tick) noexcept {
  if (tick.input.tick % config_.every == 0) waiting_.Push(tick);
}

nlohmann::json Telemetry::Status() const {
  const std::scoped_lock lock(mutex_);
  return {{"address", config_.address},
          {"port", config_.port},
          {"every", config_.every},
          {"sent", sent_},
          {"lost", not_sent_ + waiting_.dropped()},
          {"error", error_.empty() ? nlohmann::json(nullptr) : nlohmann::json(error_)}};
}

void Telemetry::Run(const std::stop_token& stop) {
  pthread_setname_np(pthread_self(), "telemetry");
  while (!stop.stop_requested()) {
    SendWaiting();
    std::unique_lock lock(mutex_);
    ended_.wait_for(lock, stop, kLook, [] { return false; });
  }
  SendWaiting();
}

void Telemetry::SendWaiting() {
  const std::int64_t utc_ns = RealtimeNow() - MonotonicNow() + epoch_ns_;  // of instant 0
  TickRecord tick{};
  while (waiting_.Pop(&tick)) {
    const double timestamp_s = static_cast<double>(utc_ns + tick.input.sampling_instant_ns) * 1e-9;
    const std::uint64_t lost = not_sent_ + waiting_.dropped();  // only this thread writes them
    std::string error = Send(TelemetryLine(source_, tick, timestamp_s, lost));
    const std::scoped_lock lock(mutex_);
    ++(error.empty() ? sent_ : not_sent_);
    error_ = std::move(error);
  }
}

// A firewall, a service that may not use the network, a cable that is out, a full buffer: the next
// sample is tried again.
std::string Telemetry::Send(const std::string& line) {
  if (!OpenSocket()) return "no socket: " + SystemError();
  const ssize_t count = sendto(socket_.get(), line.data(), line.size(), MSG_DONTWAIT | MSG_NOSIGNAL,
                               reinterpret_cast<const sockaddr*>(&receiver_), receiver_size_);
  return count < 0 ? SystemError() : std::string();
}

bool Telemetry::OpenSocket() {
  if (!socket_.is_open()) {
    socket_ =
        FileDescriptor(socket(receiver_.ss_family, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  }
  return socket_.is_open();
}

}  // namespace flexarm
