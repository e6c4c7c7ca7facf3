#pragma once

#include <cstdint>

#include "controller/types/messages.h"

namespace flexarm {

/// Makes the requests of a run without a person: arm, run once, disarm. Knows when it is over.
///
/// It reads the permit every operator period and makes a request that counts from 100 ms later on.
/// So its own thread may be late by that much and the run is still the same tick for tick.
/// Real-time safe. Thread: operator.
class UnattendedRun {
 public:
  enum class Progress : std::uint8_t {
    kArming,
    kRunning,    ///< the run has been asked for
    kDisarming,  ///< the run has ended
    kDone,       ///< Idle again, or tripped
    kRefused,    ///< a request was refused; see the answer
  };

  static constexpr std::int64_t kLeadNs = 100'000'000;
  /// The arm must have been seen at rest for half a second before it may be armed.
  static constexpr std::int64_t kFirstArmNs = 700'000'000;
  /// In lock step, the recorder has taken the last records by then.
  static constexpr std::int64_t kSettleNs = 200'000'000;

  /// @param experiment  of the run; outlives it
  /// @param settle_ns  from the end of the run until over_ns()
  explicit UnattendedRun(const PlannedExperiment* experiment, std::int64_t settle_ns = kSettleNs)
      : experiment_(experiment), settle_ns_(settle_ns) {}

  /// Once a period, in order of time.
  /// @returns the request to make now; kind kNone: none
  OperatorRequest Update(std::int64_t due_ns, const Permit& permit) noexcept;

  /// Every answer of the safety task, also to requests of others.
  void Answered(const RequestAnswer& answer) noexcept;

  Progress progress() const noexcept { return progress_; }
  bool over() const noexcept { return progress_ >= Progress::kDone; }
  bool ran() const noexcept { return ran_; }

  /// When everything of the run has been recorded: kAfterTripNs (run_recording.h) after its first
  /// trip, or the settling time after it was done or refused. INT64_MAX: it is not over.
  std::int64_t over_ns() const noexcept { return over_ns_; }
  /// Of the first trip; kNone: none.
  TripCause trip() const noexcept { return trip_; }

 private:
  OperatorRequest NextRequest(std::int64_t due_ns, const Permit& permit) noexcept;
  OperatorRequest Ask(RequestKind kind, std::int64_t not_before_ns) noexcept;

  const PlannedExperiment* experiment_;
  std::int64_t settle_ns_;
  Progress progress_ = Progress::kArming;
  RequestKind asked_ = RequestKind::kNone;  // without its effect so far
  std::uint32_t number_ = 0;
  bool ran_ = false;
  std::int64_t over_ns_ = INT64_MAX;
  TripCause trip_ = TripCause::kNone;
};

}  // namespace flexarm
