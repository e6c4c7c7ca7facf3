#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "controller/exchange/spsc_queue.h"
#include "controller/realtime/task.h"
#include "controller/safety/safety_machine.h"
#include "controller/safety/safety_monitor.h"
#include "controller/safety/safety_record.h"
#include "controller/types/messages.h"
#include "hal/safety_lines.h"

namespace flexarm {

/// Everything that the safety task touches. All of it outlives the task.
struct SafetyChannels {
  SafetyLines* lines;
  ControlReportChannel* control;            ///< read
  std::vector<DriveReportChannel*> drives;  ///< read: one a bus
  SpscQueue<OperatorRequest>* requests;     ///< read
  std::vector<PermitChannel*> permits;      ///< written: one a reader (drive, control, operator)
  SpscQueue<RequestAnswer>* answers;        ///< written
  SpscQueue<SafetyRecord>* records;         ///< written
};

/// The safety thread's body: 1 kHz, highest priority. Levels and reports in, relay and permit out.
///
/// The relay is closed in Armed, Running and Stopping; the charge pump toggles every tick while it
/// is. The permit is renewed every tick and holds from the tick's due instant. A permit published
/// at the very instant at which another thread is due may or may not be there yet: whoever must
/// agree with the lock-step run asks for the one that held just before, At(due - 1).
///
/// Requests are judged one a tick, in order of arrival among those whose `not_before_ns` has come.
/// A stop or a disarm cancels the planned arms and runs that came before it; a trip cancels all.
/// Real-time: safe after construction.
class SafetyTask final : public Task {
 public:
  static constexpr std::int64_t kPeriodNs = 1'000'000;
  static constexpr int kPriority = 90;
  static constexpr std::size_t kMaxWaiting = 32;  ///< requests; more wait in their queue

  SafetyTask(const SupervisorLimits& limits, SafetyChannels channels);

  Traits traits() const noexcept override;
  void Run(const Activation& activation) noexcept override;

  /// Safety thread only, or when no thread runs.
  SafetyStatus status() const noexcept { return status_; }

 private:
  struct Taken {
    bool any;
    OperatorRequest request;
    std::size_t earlier;  ///< requests that came before it and still wait for their time
  };

  /// The report of a drive side made of several buses: as good as its worst, as old as its oldest.
  struct DriveSide {
    DriveReport report;
    std::int64_t alive_ns;
    DriveTroubles troubles;
  };

  DriveSide ReadDrives(std::int64_t due_ns) noexcept;
  Taken TakeRequest(std::int64_t due_ns) noexcept;
  void CancelPlanned(std::size_t first, TripCauses present) noexcept;
  void Enter(const SafetyStatus& next, const SafetyInputs& in) noexcept;
  void Drive(std::int64_t due_ns) noexcept;
  void Publish(std::int64_t due_ns, LineLevels levels) noexcept;

  SafetyChannels channels_;
  SafetyMonitor monitor_;
  SafetyStatus status_{SafetyState::kStarting, TripCause::kNone};
  SafetyFacts last_facts_{};
  Evidence evidence_{};
  std::int64_t state_since_ns_ = INT64_MIN;
  std::int64_t running_since_ns_ = INT64_MIN;
  LineLevels may_open_ = 0;  // of the run that goes on
  bool pump_level_ = false;
  bool recorded_ = false;
  std::array<OperatorRequest, kMaxWaiting> waiting_{};
  std::size_t waiting_count_ = 0;
  PermitHistory permits_{kNoPermit};
};

}  // namespace flexarm
