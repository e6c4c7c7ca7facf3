#include "controller/telemetry/telemetry.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>

#include <array>

#include "tests/controller/telemetry/telemetry_parts.h"

namespace flexarm {
namespace {

using Json = nlohmann::json;

// No test waits so long unless it fails.
constexpr int kPatience_ms = 30'000;

/// A socket that receives on a port of its own.
class Receiver {
 public:
  Receiver() : socket_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    auto* generic = reinterpret_cast<sockaddr*>(&address);
    EXPECT_EQ(bind(socket_.get(), generic, sizeof address), 0);
    socklen_t size = sizeof address;
    EXPECT_EQ(getsockname(socket_.get(), generic, &size), 0);
    port_ = ntohs(address.sin_port);
  }

  TelemetryConfig config() const { return {.address = "127.0.0.1", .port = port_}; }

  Json Next() {
    pollfd ready{.fd = socket_.get(), .events = POLLIN, .revents = 0};
    if (poll(&ready, 1, kPatience_ms) != 1) return nullptr;
    std::array<char, 65'536> bytes{};
    const ssize_t count = recv(socket_.get(), bytes.data(), bytes.size(), 0);
    return Json::parse(bytes.data(), bytes.data() + count);
  }

 private:
  FileDescriptor socket_;
  int port_ = 0;
};

TickRecord SampleAt(std::int64_t tick) {
  TickRecord record{};
  record.input.tick = tick;
  record.input.sampling_instant_ns = tick * 20'000'000;
  return record;
}

TEST(Telemetry, EverySampleIsADatagramInOrder) {
  Receiver receiver;
  Telemetry telemetry(receiver.config(), ThesisSource());
  telemetry.Start(0);
  for (std::int64_t tick = 0; tick < 100; ++tick) {
    telemetry.Take(SampleAt(tick));
    if (tick % 10 != 9) continue;  // ten at once: the receiver's buffer holds no hundred
    for (std::int64_t told = tick - 9; told <= tick; ++told) {
      const Json line = receiver.Next();
      ASSERT_TRUE(line.is_object()) << told;
      ASSERT_EQ(line["tick"], told);
      ASSERT_EQ(line["lost"], 0);
    }
  }
}

TEST(Telemetry, SendsOneSampleOfSoMany) {
  Receiver receiver;
  TelemetryConfig config = receiver.config();
  config.every = 10;
  Telemetry telemetry(config, ThesisSource());
  telemetry.Start(0);
  for (std::int64_t tick = 5; tick < 35; ++tick) telemetry.Take(SampleAt(tick));
  for (const int tick : {10, 20, 30}) EXPECT_EQ(receiver.Next()["tick"], tick);
}

TEST(Telemetry, TheTimestampIsThatOfTheSamplingInstant) {
  Receiver receiver;
  Telemetry telemetry(receiver.config(), ThesisSource());
  const auto now_s = [] {
    return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch())
        .count();
  };
  const double before_s = now_s();
  timespec monotonic{};
  clock_gettime(CLOCK_MONOTONIC, &monotonic);
  telemetry.Start(monotonic.tv_sec * std::int64_t{1'000'000'000} + monotonic.tv_nsec);
  const double after_s = now_s();
  telemetry.Take(SampleAt(50));  // a second after instant 0
  const double told_s = receiver.Next()["timestamp_s"];
  EXPECT_GE(told_s, before_s + 1.0 - 1e-3) << "1 ms: NTP may turn the clock while this runs";
  EXPECT_LE(told_s, after_s + 1.0 + 1e-3);
}

// The thread that empties the queue is not there yet.
TEST(Telemetry, WhatDoesNotFitIsLostAndCounted) {
  Receiver receiver;
  Telemetry telemetry(receiver.config(), ThesisSource());
  for (std::int64_t tick = 0; tick < 2'000; ++tick) telemetry.Take(SampleAt(tick));
  const std::uint64_t lost = telemetry.Status()["lost"];
  EXPECT_GT(lost, 0u);
  EXPECT_LE(lost, 2'000 - Telemetry::kDepth);
  telemetry.Start(0);
  EXPECT_EQ(receiver.Next()["lost"], lost) << "and the receiver is told";
}

TEST(Telemetry, AnAddressThatCannotBeReachedIsAnErrorOfTheStatus) {
  // Broadcast, which a socket may not send unless it has asked for it: EACCES.
  Telemetry telemetry({.address = "255.255.255.255", .port = 9}, ThesisSource());
  telemetry.Start(0);
  telemetry.Take(SampleAt(0));
  const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(kPatience_ms);
  while (telemetry.Status()["lost"] == 0 && std::chrono::steady_clock::now() < end) {
    std::this_thread::yield();
  }
  const Json status = telemetry.Status();
  EXPECT_EQ(status["sent"], 0);
  EXPECT_EQ(status["lost"], 1);
  EXPECT_TRUE(status["error"].is_string()) << status;
}

TEST(Telemetry, ItsEndSendsWhatWaits) {
  Receiver receiver;
  {
    Telemetry telemetry(receiver.config(), ThesisSource());
    telemetry.Start(0);
    telemetry.Take(SampleAt(7));
  }
  EXPECT_EQ(receiver.Next()["tick"], 7);
}

}  // namespace
}  // namespace flexarm
