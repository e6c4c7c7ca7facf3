#include "controller/realtime/wakeup.h"

#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <ctime>

#include "controller/realtime/clock.h"
#include "hal/time_units.h"

namespace flexarm {

static_assert(sizeof(std::atomic<std::uint32_t>) == sizeof(std::uint32_t), "the kernel reads it");

void Wakeup::Wake() noexcept {
  if (set_.exchange(1, std::memory_order_acq_rel) != 0) return;  // it is woken already
  syscall(SYS_futex, &set_, FUTEX_WAKE_PRIVATE, 1, nullptr, nullptr, 0);
}

bool Wakeup::SleepUntil(std::int64_t instant_ns) noexcept {
  while (!Take()) {
    if (MonotonicNow() >= instant_ns) return false;
    const timespec instant{.tv_sec = instant_ns / kSecondNs, .tv_nsec = instant_ns % kSecondNs};
    // An absolute instant of CLOCK_MONOTONIC. It returns for a wake, for a signal, or in time.
    syscall(SYS_futex, &set_, FUTEX_WAIT_BITSET_PRIVATE, 0, &instant, nullptr,
            FUTEX_BITSET_MATCH_ANY);
  }
  return true;
}

}  // namespace flexarm
