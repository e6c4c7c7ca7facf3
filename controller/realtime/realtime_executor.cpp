#include "controller/realtime/realtime_executor.h"

#include <sched.h>
#include <sys/prctl.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>

#include "controller/realtime/alternate_stack.h"
#include "controller/realtime/clock.h"
#include "controller/realtime/float_environment.h"
#include "controller/realtime/wakeup.h"

namespace flexarm {
namespace {

constexpr std::size_t kStackBytes = std::size_t{2} << 20;  // a sanitizer uses 1 MiB of it
constexpr std::size_t kPrefaultBytes = std::size_t{256} << 10;
constexpr std::size_t kPageBytes = 4096;  // the smallest of any processor; some have 16 KiB

template <typename T>
void Increase(std::atomic<T>& counter, T amount) noexcept {
  // Only one thread writes, so no atomic read-modify-write is needed.
  counter.store(counter.load(std::memory_order_relaxed) + amount, std::memory_order_relaxed);
}

void Raise(std::atomic<std::int64_t>& worst, std::int64_t value) noexcept {
  if (value > worst.load(std::memory_order_relaxed)) worst.store(value, std::memory_order_relaxed);
}

// Writes to each stack page that the task may use later, to avoid page faults then.
[[gnu::noinline]] void PrefaultStack() noexcept {
  std::array<unsigned char, kPrefaultBytes> stack;
  for (std::size_t i = 0; i < kPrefaultBytes; i += kPageBytes) stack[i] = 0;
  asm volatile("" : : "r"(stack.data()) : "memory");  // keeps the compiler from removing the writes
}

// Linux keeps 15 characters of a thread's name and refuses a longer one. Of a long name the end is
// kept too: it tells "strain-amplifier-1" from "strain-amplifier-2".
void NameThisThread(const char* name) noexcept {
  constexpr std::size_t kMaxLength = 15, kTail = 6;
  std::array<char, kMaxLength + 1> kept{};
  const std::size_t length = std::strlen(name);
  std::copy_n(name, std::min(length, kMaxLength), kept.begin());
  if (length > kMaxLength) {
    std::copy_n(name + length - kTail, kTail, kept.end() - 1 - kTail);
    kept[kMaxLength - kTail - 1] = '~';
  }
  pthread_setname_np(pthread_self(), kept.data());
}

[[noreturn]] void ThrowRefused(const Task::Traits& traits, bool fifo, int error) {
  std::string text = std::string("cannot start thread '") + traits.name + "'";
  if (fifo) text += " with SCHED_FIFO priority " + std::to_string(traits.priority);
  text += std::string(": ") + std::strerror(error);
  if (fifo && error == EPERM) {
    text += "; set LimitRTPRIO=99 in the systemd unit, run as root, or use --without-realtime";
  }
  throw std::runtime_error(text);
}

}  // namespace

RealtimeExecutor::RealtimeExecutor(bool fifo) : fifo_(fifo) {}

RealtimeExecutor::~RealtimeExecutor() {
  RequestStop();
  Join();
}

void RealtimeExecutor::Add(Task& task, SpscQueue<TimingRecord>* timing) {
  const Task::Traits traits = task.traits();
  if (traits.period_ns < 1 || traits.phase_ns < 0) {
    throw std::invalid_argument(
        std::string(traits.name) +
        ": a task needs a period of at least 1 ns and a phase of 0 or more");
  }
  if (traits.priority < 0 || traits.priority > 98) {
    throw std::invalid_argument(
        std::string(traits.name) +
        ": the priority must lie in 0..98 (99 starves the kernel's threads)");
  }
  auto thread = std::make_unique<Thread>();
  thread->executor = this;
  thread->task = &task;
  thread->traits = traits;
  thread->timing = timing;
  threads_.push_back(std::move(thread));
}

void RealtimeExecutor::Start(std::int64_t epoch_ns, std::int64_t end_ns) {
  epoch_ns_ = epoch_ns;
  end_ns_ = end_ns;
  try {
    for (const auto& thread : threads_) StartThread(*thread);
  } catch (...) {
    RequestStop();
    Join();
    throw;
  }
}

void RealtimeExecutor::StartThread(Thread& thread) {
  const bool fifo = fifo_ && thread.traits.priority > 0;
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstacksize(&attributes, kStackBytes);
  // Explicit in both cases, so that nothing is inherited from the starting thread.
  pthread_attr_setinheritsched(&attributes, PTHREAD_EXPLICIT_SCHED);
  pthread_attr_setschedpolicy(&attributes, fifo ? SCHED_FIFO : SCHED_OTHER);
  const sched_param parameters{.sched_priority = fifo ? thread.traits.priority : 0};
  pthread_attr_setschedparam(&attributes, &parameters);
  const int error = pthread_create(&thread.handle, &attributes, &Main, &thread);
  pthread_attr_destroy(&attributes);
  if (error != 0) ThrowRefused(thread.traits, fifo, error);
  thread.started = true;
}

void* RealtimeExecutor::Main(void* argument) noexcept {
  auto& thread = *static_cast<Thread*>(argument);
  NameThisThread(thread.traits.name);
  const AlternateStack alternate_stack;
  prctl(PR_SET_TIMERSLACK, 1UL);
  PrefaultStack();
  const FlushDenormals flush;
  thread.executor->Loop(thread);
  thread.task->Ended();
  return nullptr;
}

void RealtimeExecutor::AwaitDue(Task& task, std::int64_t due_ns) noexcept {
  Wakeup* wakeup = task.wakeup();
  if (wakeup == nullptr) return SleepUntil(epoch_ns_ + due_ns);
  while (wakeup->SleepUntil(epoch_ns_ + due_ns)) {
    if (stop_.load(std::memory_order_relaxed)) return;
    task.Woken(MonotonicNow() - epoch_ns_);
  }
}

void RealtimeExecutor::Loop(Thread& thread) noexcept {
  const Task::Traits& traits = thread.traits;
  Counters& counters = thread.counters;
  int missed_in_a_row = 0;
  std::int64_t finished_ns = INT64_MIN;
  std::int64_t run_ns = 0;
  for (std::int64_t due_ns = traits.phase_ns; due_ns < end_ns_; due_ns += traits.period_ns) {
    AwaitDue(*thread.task, due_ns);
    if (stop_.load(std::memory_order_relaxed)) return;
    const std::int64_t woke_ns = MonotonicNow() - epoch_ns_;

    // A task that was still running at its due instant was not late to wake.
    const std::int64_t lateness_ns =
        std::max<std::int64_t>(woke_ns - std::max(due_ns, finished_ns), 0);

    // Whole periods that have passed are skipped; the current one is run late.
    const std::int64_t behind = std::max<std::int64_t>((woke_ns - due_ns) / traits.period_ns, 0);
    if (behind > 0) {
      due_ns += behind * traits.period_ns;
      missed_in_a_row += static_cast<int>(std::min<std::int64_t>(behind, 1'000'000));
      Increase<std::uint64_t>(counters.skipped_periods, static_cast<std::uint64_t>(behind));
      if (due_ns >= end_ns_) return;
    }

    thread.task->Run({.due_ns = due_ns,
                      .missed_in_a_row = missed_in_a_row,
                      .late_ns = woke_ns - due_ns,
                      .previous_run_ns = run_ns});
    finished_ns = MonotonicNow() - epoch_ns_;
    run_ns = finished_ns - woke_ns;

    if (finished_ns > due_ns + traits.deadline_ns) {
      ++missed_in_a_row;
      Increase<std::uint64_t>(counters.missed_deadlines, 1);
    } else {
      missed_in_a_row = 0;
    }
    Increase<std::int64_t>(counters.total_lateness_ns, lateness_ns);
    Raise(counters.worst_lateness_ns, lateness_ns);
    Raise(counters.worst_run_ns, run_ns);
    Increase<std::uint64_t>(counters.activations, 1);
    if (thread.timing != nullptr) {
      thread.timing->Push({.tick = (due_ns - traits.phase_ns) / traits.period_ns,
                           .due_ns = due_ns,
                           .woke_ns = woke_ns,
                           .finished_ns = finished_ns});
    }
  }
}

void RealtimeExecutor::RequestStop() noexcept { stop_.store(true, std::memory_order_relaxed); }

void RealtimeExecutor::Join() {
  for (const auto& thread : threads_) {
    if (!thread->started) continue;
    pthread_join(thread->handle, nullptr);
    thread->started = false;
  }
}

TaskStatistics RealtimeExecutor::statistics(std::size_t index) const noexcept {
  const Thread& thread = *threads_[index];
  const Counters& counters = thread.counters;
  const std::uint64_t activations = counters.activations.load(std::memory_order_relaxed);
  const auto total =
      static_cast<double>(counters.total_lateness_ns.load(std::memory_order_relaxed));
  return {.name = thread.traits.name,
          .activations = activations,
          .missed_deadlines = counters.missed_deadlines.load(std::memory_order_relaxed),
          .skipped_periods = counters.skipped_periods.load(std::memory_order_relaxed),
          .worst_lateness_ns = counters.worst_lateness_ns.load(std::memory_order_relaxed),
          .mean_lateness_ns = activations > 0 ? total / static_cast<double>(activations) : 0.0,
          .worst_run_ns = counters.worst_run_ns.load(std::memory_order_relaxed)};
}

}  // namespace flexarm
