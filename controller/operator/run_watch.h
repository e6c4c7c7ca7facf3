#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "controller/types/messages.h"
#include "controller/types/records.h"

namespace flexarm {

/// The present run, or the last: since when it goes on, how long it takes, and how it ended. Also
/// of `pluck` and `home`. Not real-time safe. Thread: operator.
class RunWatch {
 public:
  explicit RunWatch(double period_s) : period_s_(period_s) {}

  /// Every answer of the safety task. The experiment of a run that was granted is named `name`.
  void Answered(const RequestAnswer& answer, const std::string& name);

  /// Once a period. @param tick  the newest  @param shutting_down  the daemon ends, and stops the
  /// run
  void Follow(std::int64_t now_ns, const Permit& permit, const TickRecord& tick,
              bool shutting_down);

  /// For the status: null before the first run, or {"number", "name", "outcome", "elapsed_s",
  /// "duration_s", "trip", "speed_percent"}. "outcome" is "running" until the arm is at rest, then
  /// "done", "stopped" or "tripped"; "duration_s" is null for a motion that ends when it has found
  /// something, or is paused; "trip" is the cause, else null; "speed_percent" is the speed along
  /// the path, 0 while it is paused, and null for a motion that follows none.
  nlohmann::json Json() const;

 private:
  enum class Outcome : std::uint8_t { kNone, kRunning, kDone, kStopped, kTripped };
  static const char* ToString(Outcome outcome);

  /// Of the experiment that is followed now.
  void Describe(const PlannedExperiment* experiment, bool homes, int sample);

  double period_s_;
  Outcome outcome_ = Outcome::kNone;
  std::uint32_t number_ = 0;
  std::string name_;
  double elapsed_s_ = 0.0;
  double duration_s_ = 0.0;              // 0: until it has found something
  std::optional<double> speed_{};        // share of the planned one; of a path that is followed
  std::optional<std::uint32_t> seen_{};  // its permit was seen, with this change
  bool stopped_ = false;                 // a stop was granted
  TripCause trip_ = TripCause::kNone;
};

}  // namespace flexarm
