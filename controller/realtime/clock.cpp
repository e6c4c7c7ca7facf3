#include "controller/realtime/clock.h"

#include <cerrno>
#include <ctime>

#include "hal/time_units.h"

namespace flexarm {
namespace {

std::int64_t Now(clockid_t clock) noexcept {
  timespec now{};
  clock_gettime(clock, &now);
  return now.tv_sec * kSecondNs + now.tv_nsec;
}

}  // namespace

std::int64_t MonotonicNow() noexcept { return Now(CLOCK_MONOTONIC); }

std::int64_t RealtimeNow() noexcept { return Now(CLOCK_REALTIME); }

void SleepUntil(std::int64_t instant_ns) noexcept {
  if (instant_ns < 0) return;  // before the origin of the clock: already past
  const timespec instant{.tv_sec = instant_ns / kSecondNs, .tv_nsec = instant_ns % kSecondNs};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &instant, nullptr) == EINTR) {
  }
}

}  // namespace flexarm
