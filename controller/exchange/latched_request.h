#pragma once

#include <atomic>
#include <cstdint>

namespace flexarm {

/// A request that waits in no queue, so that nothing can delay it or leave it without room: it
/// stays set until its reader takes it. A newer one replaces it; the answer to a number answers
/// every lower one too. One writer, one reader. Real-time: safe.
class LatchedRequest {
 public:
  /// @param number  of the request, ascending, above 0
  void Set(std::uint32_t number) noexcept { number_.store(number, std::memory_order_release); }

  /// The number of the request that is set, which is then no longer set; 0: none is.
  std::uint32_t Take() noexcept { return number_.exchange(0, std::memory_order_acq_rel); }

 private:
  std::atomic<std::uint32_t> number_{0};
};

}  // namespace flexarm
