#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "controller/exchange/latched_request.h"
#include "controller/exchange/spsc_queue.h"
#include "controller/realtime/task.h"
#include "controller/realtime/wakeup.h"
#include "controller/safety/line_filter.h"
#include "controller/safety/safety_machine.h"
#include "controller/safety/safety_monitor.h"
#include "controller/safety/safety_record.h"
#include "controller/types/loop_grid.h"
#include "controller/types/messages.h"
#include "controller/types/present_causes.h"
#include "hal/safety_lines.h"

namespace flexarm {

/// Channels of the safety task. All outlive the task.
struct SafetyChannels {
  SafetyLines* lines;
  ControlReportChannel* control;            ///< read
  std::vector<DriveReportChannel*> drives;  ///< read: one a bus
  SpscQueue<OperatorRequest>* requests;     ///< read: arm, run, reset, and planned ones
  LatchedRequest* stop;                     ///< read: before every queued request
  LatchedRequest* disarm;                   ///< read: the same
  const std::atomic<bool>* shutting_down;   ///< read: stop and disarm the arm, start nothing
  const std::atomic<bool>* reduced;         ///< read while the drives are off: reduced limits
  std::vector<Wakeup*> wakeups;             ///< woken when the power goes: the drives' buses
  std::vector<PermitChannel*> permits;      ///< written: one a reader (drive, control, operator)
  SpscQueue<RequestAnswer>* answers;        ///< written
  SpscQueue<SafetyRecord>* records;         ///< written
  TimingChannel* timing;                    ///< written when it changes: for the operator task
  PresentCausesChannel* present;            ///< written while a cause is present: the same
};

/// The safety task: 1 kHz, highest priority. Levels and reports in, relay and permit out.
///
/// The relay is closed in the states of RelayClosed; the charge pump toggles every tick in those of
/// PumpRuns. The permit is renewed every tick and valid from the tick's due instant. A permit
/// published at the due instant of another task may not be visible to it yet: a task that must
/// agree with the lock-step run reads the permit before, At(due - 1).
///
/// One request is judged per tick: a latched stop or disarm, else the first in order of arrival of
/// those whose `not_before_ns` has passed or that are cancelled; a run waits while the drives are
/// being enabled, and a reset while the drives acknowledge their faults: `acknowledge` is in the
/// permit then. A stop or a disarm cancels the arms and runs of lower numbers that came before it;
/// a trip cancels all. The run that is granted is in the permit from that tick on. A disarm is
/// answered when the relay is open, because people reach into the arm then; one that comes while
/// disarming takes the place of the one before. An arm is answered when the tests of the power
/// path, if there are any, are over.
///
/// A tick that comes late is judged like any other before it touches the lines: where late threads
/// trip, relay and pump stay off from it on. Real-time: safe after construction.
class SafetyTask final : public Task {
 public:
  static constexpr std::int64_t kPeriodNs = 1'000'000;
  static constexpr int kPriority = 90;
  static constexpr std::size_t kMaxWaiting = 32;  ///< requests; others stay in the queue
  /// A run waits so long after arming for the drives, which charge a circuit or release a brake.
  static constexpr std::int64_t kEnableNs = 1'500'000'000;
  /// A reset waits so long for the drives to leave their faults, and for the arm to be at rest
  /// then.
  static constexpr std::int64_t kAcknowledgeNs = 2'000'000'000;

  /// A tick comes so long before each step, and before each exchange of the buses where
  /// `loop.acquire_before_ms` is a whole number: the thread of neither waits for this one when it
  /// wakes, and an exchange carries what the tick has decided.
  static constexpr std::int64_t kLeadNs = 100'000;
  static constexpr std::int64_t PhaseNs(const LoopGrid& grid) {
    return (grid.phase_ns + kPeriodNs - kLeadNs) % kPeriodNs;
  }

  /// @param phase_ns  of its ticks, below a period
  SafetyTask(const MonitorLimits& limits, SafetyChannels channels, std::int64_t phase_ns = 0);

  Traits traits() const noexcept override;
  void Run(const Activation& activation) noexcept override;
  /// Opens the relay: whatever the other threads do, nothing watches the arm from here on.
  void Ended() noexcept override;

  /// Before the first tick: the arm starts Tripped, by a trip from before the start.
  void StartTripped(TripCause cause, const Evidence& evidence) noexcept {
    status_ = {SafetyState::kTripped, cause};
    evidence_ = evidence;
  }

  /// Safety thread only, or when no thread runs.
  SafetyStatus status() const noexcept { return status_; }

 private:
  /// Report of all buses of the drives: the worst status and the oldest age of them.
  struct DriveSide {
    DriveReport report;
    std::int64_t alive_ns;
    DriveTroubles troubles;
  };

  struct Waiting {
    OperatorRequest request;
    bool cancelled;
  };

  DriveSide ReadDrives(std::int64_t due_ns) noexcept;
  /// Kind kNone: there is none in this tick.
  OperatorRequest TakeRequest(std::int64_t due_ns, const DriveReport& drives) noexcept;
  /// A change of a path that is no longer followed, or that should have changed before.
  bool TooLate(const OperatorRequest& change, std::int64_t due_ns) const noexcept {
    return status_.state == SafetyState::kRunning &&
           (change.changes != run_number_ || due_ns > change.not_after_ns);
  }
  /// True while `reset`, which is due, waits for the drives.
  bool Acknowledges(const OperatorRequest& reset, std::int64_t due_ns,
                    const DriveReport& drives) noexcept;
  void Receive() noexcept;
  /// Arms, runs and changes of a lower number that were asked for until now are refused when their
  /// turn comes.
  void CancelBelow(std::uint32_t number) noexcept;
  void Enter(const SafetyStatus& next, const SafetyInputs& in,
             const OperatorRequest& request) noexcept;
  void Answer(const OperatorRequest& request, Refusal refusal, SafetyState judged_in,
              TripCauses present) noexcept;
  void AnswerRequests(const OperatorRequest& request, Refusal refusal, SafetyState before,
                      const SafetyFacts& facts) noexcept;
  Refusal RefusalOfArm(const SafetyFacts& facts) const noexcept;
  void Drive(std::int64_t due_ns) noexcept;
  /// Age of the permit that this tick renews; 0: it is the first.
  std::int64_t PermitAgeNs(const Activation& activation) const noexcept;
  void Publish(std::int64_t due_ns, LineLevels levels) noexcept;
  void PublishPresent(TripCauses causes, const SafetyInputs& in) noexcept;

  SafetyChannels channels_;
  std::int64_t phase_ns_;
  SafetyMonitor monitor_;
  SafetyStatus status_{SafetyState::kStarting, TripCause::kNone};
  SafetyFacts last_facts_{};
  Evidence evidence_{};
  std::int64_t state_since_ns_ = INT64_MIN;
  std::int64_t running_since_ns_ = INT64_MIN;
  std::uint32_t run_number_ = 0;  // of the present run, or of the last
  RunOrder run_{};
  RunChange change_{};   // of that run
  bool reduced_ = true;  // the limits, since the relay was last open
  LineFilter filter_;
  SafetyLines::Call written_{};      // the write of the last tick: this tick judges it
  std::uint32_t acknowledging_ = 0;  // number of the reset that waits for the drives; 0: none
  std::int64_t acknowledging_since_ns_ = 0;
  bool acknowledge_ = false;  // in this tick
  bool pump_level_ = false;
  bool recorded_ = false;
  OperatorRequest arm_{};     // the power path is being tested; number 0: none
  OperatorRequest disarm_{};  // carried out, answered once the relay is open; number 0: none
  std::array<Waiting, kMaxWaiting> waiting_{};
  std::size_t waiting_count_ = 0;
  std::size_t queued_ = 0;             // requests of the queue from before the last CancelBelow
  std::uint32_t cancelled_below_ = 0;  // its number
  PermitHistory permits_{kNoPermit};
  TimingCounts timing_{};    // as last published
  PresentCauses present_{};  // the same
};

}  // namespace flexarm
