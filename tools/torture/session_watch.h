#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "controller/safety/safety_machine.h"
#include "controller/tasks/safety_task.h"
#include "controller/types/loop_grid.h"
#include "controller/types/rig_config.h"
#include "hal/safety_lines.h"
#include "hal/sim/plant_truth.h"
#include "tools/torture/fault.h"

namespace flexarm {

/// A rule that a session broke.
struct Violation {
  std::int64_t at_ns;
  std::string rule;  ///< short name of the rule
  std::string what;  ///< what was found, with numbers
};

/// What a session shows at one instant.
struct WatchSample {
  SafetyStatus status;              ///< of the safety task
  SafetyLines::Outputs told;        ///< what it told relay and pump
  std::array<double, 2> torque_nm;  ///< behind the drive's gate
  std::int64_t arm_ns;              ///< the arm has been simulated up to here
  PlantTruth truth;                 ///< of the arm then
  double strain_share;              ///< largest true strain at a gauge over its limit
};

/// Largest values in a session.
struct Peaks {
  double torque_share = 0.0;  ///< of the torque limit
  double angle_share = 0.0;   ///< true hub angle over the soft limit, while a torque acts
  double rate_share =
      0.0;  ///< true hub rate, mean of a period, over its limit, while a torque acts
  double strain_share = 0.0;  ///< true strain at a gauge over its limit, while a torque acts
};

/// Raises each of `most` that is less than that of `by`.
void Raise(const Peaks& by, Peaks* most);

/// Which rules hold in a session, by its faults.
struct WatchRules {
  /// Torque may stay for so long after the tick in which the state stopped allowing it, in the time
  /// of the arm's thread; -1: a slice that begins then or later has none.
  std::int64_t torque_after_ns;
  Peaks most;                             ///< torque_share is always 1
  std::array<bool, 2> angle_hidden = {};  ///< a joint whose hub angle nothing measures: not judged
};

/// Watches a session from outside, every millisecond: torque only while it is permitted, limits of
/// torque and slew, envelopes of the true arm, relay, latch, and that nothing starts by itself.
class SessionWatch {
 public:
  SessionWatch(const RigConfig& config, const WatchRules& rules)
      : config_(config), rules_(rules), phase_ns_(SafetyTask::PhaseNs(LoopGrid(config.loop))) {}

  /// What the operator has sent: without it, these changes of state are violations. One change uses
  /// up all of its command that have been sent before.
  void Allow(const std::string& command) { sent_.insert(command); }
  /// The button has been pressed for long enough.
  void ButtonPressed() { button_ = true; }

  /// Every millisecond.
  void Look(std::int64_t now_ns, const WatchSample& sample);

  struct Latched {
    TripCause cause;
    std::int64_t at_ns;
  };
  /// The first cause that latched; nothing: none.
  const std::optional<Latched>& first_cause() const { return first_cause_; }
  /// From now on the first cause, the peaks and the track are noted.
  void Restart() {
    first_cause_.reset();
    peaks_ = {};
    tip_m_.clear();
    last_torque_ns_ = INT64_MIN;
  }
  /// The true tip, x and y, of every millisecond since Restart.
  const std::vector<std::array<double, 2>>& tip_m() const { return tip_m_; }
  /// The last millisecond with torque at a joint; INT64_MIN: there was none since Restart.
  std::int64_t last_torque_ns() const { return last_torque_ns_; }
  /// When the last run was granted: the loop begins from the start with it. INT64_MIN: none.
  std::int64_t granted_ns() const { return granted_ns_; }
  const std::vector<Violation>& violations() const { return violations_; }
  const Peaks& peaks() const { return peaks_; }

  void Add(std::int64_t at_ns, const char* rule, const std::string& what);

 private:
  void LookAtTorque(std::int64_t now_ns, const WatchSample& sample);
  void LookAtArm(std::int64_t now_ns, const WatchSample& sample);
  void LookAtState(std::int64_t now_ns, const WatchSample& sample);
  bool TakeSent(const char* command) { return sent_.erase(command) > 0; }
  void Over(std::int64_t now_ns, const char* what, double share, double most, double* peak);

  const RigConfig& config_;
  WatchRules rules_;
  std::int64_t phase_ns_;  // of the safety task
  std::vector<Violation> violations_;
  std::set<std::string> sent_;  // and not used up
  SafetyStatus status_{SafetyState::kStarting, TripCause::kNone};
  std::optional<Latched> first_cause_;
  std::int64_t granted_ns_ = INT64_MIN;
  // Since when torque has not been allowed, of the last milliseconds, the newest last; INT64_MAX:
  // it is.
  std::deque<std::int64_t> forbidden_since_ns_;
  std::array<double, 2> torque_nm_{};  // in the millisecond before
  bool button_ = false;
  Peaks peaks_;
  std::vector<std::array<double, 2>> tip_m_;
  std::deque<std::array<double, 2>> hub_rad_;  // of the last period, by millisecond
  std::int64_t arm_ns_ = 0;                    // WatchSample::arm_ns, the millisecond before
  std::int64_t last_torque_ns_ = INT64_MIN;
};

}  // namespace flexarm
