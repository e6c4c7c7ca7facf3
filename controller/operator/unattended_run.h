#pragma once

#include <cstdint>

#include "controller/types/messages.h"

namespace flexarm {

/// The operator of a run without a person: arms, runs once, disarms. Simulated backend only.
///
/// It looks at the permit every operator period and asks for the next step in a request that counts
/// from 100 ms later on. So its own thread may be late by that much and the run is still the same
/// tick for tick.
class UnattendedRun {
 public:
  enum class Progress : std::uint8_t {
    kArming,
    kRunning,    ///< the run has been asked for
    kDisarming,  ///< the run is over
    kDone,       ///< Idle again, or tripped
    kRefused,    ///< a request was refused; see the answer
  };

  static constexpr std::int64_t kLeadNs = 100'000'000;
  /// The arm must have been seen at rest for half a second before it may be armed.
  static constexpr std::int64_t kFirstArmNs = 700'000'000;

  /// @returns the request to make now; kind kNone: none
  OperatorRequest Update(std::int64_t due_ns, const Permit& permit) noexcept;

  void Answered(const RequestAnswer& answer) noexcept;

  Progress progress() const noexcept { return progress_; }
  bool over() const noexcept { return progress_ >= Progress::kDone; }
  bool ran() const noexcept { return ran_; }

 private:
  OperatorRequest Ask(RequestKind kind, std::int64_t not_before_ns) noexcept;

  Progress progress_ = Progress::kArming;
  RequestKind asked_ = RequestKind::kNone;  // without its effect so far
  std::uint32_t number_ = 0;
  bool ran_ = false;
};

}  // namespace flexarm
