#pragma once

#include <cstdint>

#include "controller/types/safety_config.h"
#include "controller/types/safety_state.h"

namespace flexarm {

/// Waits for the safe end of the arm after LoopStack::RequestShutdown: the safety task stops the
/// run and disarms.
///
/// It is over once the arm is Idle, tripped or still starting, or after LimitNs in any state, and
/// kSettleNs have passed since then. Real-time safe. Thread: operator.
class Shutdown {
 public:
  static constexpr std::int64_t kSettleNs = 300'000'000;  ///< the recorder takes the last records

  /// Longer than the longest stop, which trips after safety.stop_timeout_s.
  static std::int64_t LimitNs(const SafetyConfig& safety);

  /// @param limit_ns  LimitNs of the rig
  explicit Shutdown(std::int64_t limit_ns) : limit_ns_(limit_ns) {}

  /// @param end_ns  when the daemon ends anyway, which then replaces the settling time;
  ///                INT64_MAX: it does not
  void Begin(std::int64_t now_ns, std::int64_t end_ns) noexcept;
  bool begun() const noexcept { return begun_ns_ != INT64_MAX; }

  /// Once a period after Begin.
  void Update(std::int64_t now_ns, SafetyState state) noexcept;

  bool over() const noexcept { return over_; }

 private:
  std::int64_t limit_ns_;
  std::int64_t begun_ns_ = INT64_MAX;
  std::int64_t end_ns_ = INT64_MAX;
  bool over_ = false;
};

}  // namespace flexarm
