#pragma once

#include <memory>
#include <utility>

#include "controller/exchange/spsc_queue.h"
#include "controller/types/records.h"

namespace flexarm {

/// Single-producer single-consumer queue of events, from the operator thread to the recorder.
/// Allocates: not for real-time threads.
class EventQueue {
 public:
  explicit EventQueue(std::size_t capacity) : queue_(capacity) {}
  ~EventQueue() {
    RunEvent* event = nullptr;
    while (queue_.Pop(&event)) delete event;
  }
  EventQueue(const EventQueue&) = delete;
  EventQueue& operator=(const EventQueue&) = delete;

  /// Operator thread only. False if there is no room: the event is dropped and counted.
  bool Push(RunEvent event) {
    auto owned = std::make_unique<RunEvent>(std::move(event));
    if (!queue_.Push(owned.get())) return false;
    static_cast<void>(owned.release());  // the queue owns it now
    return true;
  }

  /// Recorder thread only. False if the queue is empty.
  bool Pop(RunEvent* event) {
    RunEvent* found = nullptr;
    if (!queue_.Pop(&found)) return false;
    *event = std::move(*std::unique_ptr<RunEvent>(found));
    return true;
  }

  std::uint64_t dropped() const noexcept { return queue_.dropped(); }

 private:
  SpscQueue<RunEvent*> queue_;
};

}  // namespace flexarm
