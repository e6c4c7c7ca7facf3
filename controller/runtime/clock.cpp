#include "controller/runtime/clock.h"

#include <cerrno>
#include <ctime>

namespace flexarm {
namespace {

constexpr std::int64_t kSecondNs = 1'000'000'000;

}  // namespace

std::int64_t MonotonicNow() noexcept {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * kSecondNs + now.tv_nsec;
}

void SleepUntil(std::int64_t instant_ns) noexcept {
  if (instant_ns < 0) return;  // before the clock's zero: passed
  const timespec instant{.tv_sec = instant_ns / kSecondNs, .tv_nsec = instant_ns % kSecondNs};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &instant, nullptr) == EINTR) {
  }
}

}  // namespace flexarm
