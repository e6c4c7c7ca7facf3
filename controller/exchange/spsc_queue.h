#pragma once

#include <readerwriterqueue/readerwriterqueue.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#if defined(__SANITIZE_THREAD__)
#include <sanitizer/tsan_interface.h>
extern "C" {
void AnnotateIgnoreReadsBegin(const char* file, int line);
void AnnotateIgnoreReadsEnd(const char* file, int line);
void AnnotateIgnoreWritesBegin(const char* file, int line);
void AnnotateIgnoreWritesEnd(const char* file, int line);
}
#endif

namespace flexarm {

/// Single-producer single-consumer queue: passes every value from one thread to another, in order.
/// Never allocates after construction: a value that does not fit is dropped and counted, so a gap
/// is never silent.
///
/// Real-time: safe on both sides, wait-free. Not copyable, not movable.
template <typename T>
class SpscQueue {
  static_assert(std::is_trivially_copyable_v<T>, "a copy of T must not allocate or throw");

 public:
  /// Holds at least `capacity` values.
  explicit SpscQueue(std::size_t capacity) : queue_(capacity) {}
  SpscQueue(const SpscQueue&) = delete;
  SpscQueue& operator=(const SpscQueue&) = delete;

  /// Producer thread only. False if there is no room: the value is dropped and counted.
  bool Push(const T& value) noexcept {
    Release();
    const Unchecked unchecked;
    if (queue_.try_enqueue(value)) return true;
    dropped_.store(dropped_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
    return false;
  }

  /// Consumer thread only. False if the queue is empty.
  bool Pop(T* value) noexcept {
    const bool found = Dequeue(value);
    if (found) Acquire();
    return found;
  }

  /// Any thread. Number of values that did not fit since construction.
  std::uint64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }

  /// Any thread. Number of waiting values, approximate while the other thread is active.
  std::size_t size() const noexcept {
    const Unchecked unchecked;
    return queue_.size_approx();
  }

 private:
#if defined(__SANITIZE_THREAD__)
  // The queue orders its memory accesses by fences, which the thread sanitizer does not model. The
  // annotations state this order and exclude the inside of the queue from the check.
  struct Unchecked {
    Unchecked() noexcept {
      AnnotateIgnoreReadsBegin(__FILE__, __LINE__);
      AnnotateIgnoreWritesBegin(__FILE__, __LINE__);
    }
    ~Unchecked() {
      AnnotateIgnoreWritesEnd(__FILE__, __LINE__);
      AnnotateIgnoreReadsEnd(__FILE__, __LINE__);
    }
  };
  void Release() noexcept { __tsan_release(this); }
  void Acquire() noexcept { __tsan_acquire(this); }
#else
  struct Unchecked {
    Unchecked() noexcept {}  // user-provided, so that the variable does not count as unused
  };
  void Release() noexcept {}
  void Acquire() noexcept {}
#endif

  bool Dequeue(T* value) noexcept {
    const Unchecked unchecked;
    return queue_.try_dequeue(*value);
  }

  moodycamel::ReaderWriterQueue<T> queue_;
  std::atomic<std::uint64_t> dropped_{0};
};

}  // namespace flexarm
