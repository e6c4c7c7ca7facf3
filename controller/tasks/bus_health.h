#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "controller/types/messages.h"
#include "controller/types/trip_cause.h"

namespace flexarm {

/// One of BusDevice::counter_values.
struct BusCounter {
  const char* name;
  std::uint32_t value;
};

/// Health of one bus of a wired rig, for status and journal.
struct BusHealth {
  std::string name;
  bool ok;
  std::string fault;         ///< error of its last exchange, with device and node; empty: none
  std::uint32_t failed;      ///< number of failed exchanges and attempts to reconnect
  std::uint32_t recovered;   ///< number of recoveries after a loss
  std::uint32_t slow = 0;    ///< number of exchanges that took longer than the bus declares
  double longest_ms = 0.0;   ///< longest exchange
  double declared_ms = 0.0;  ///< what the bus declares as the longest
  int failed_in_window = 0;  ///< among the last safety.window_periods
  int slow_in_window = 0;
  bool in_fault = false;  ///< it answers, and `fault` is a drive's, until the operator resets
  std::string notice{};   ///< what a drive reports that is no fault (BusDevice::notice)
  std::vector<BusCounter> counters{};
};

/// Reports to the journal when a bus is lost or reconnected, a drive's fault with its end, a notice
/// of a drive, and, at most once a second, exchanges that failed without a loss of the bus. Thread:
/// operator.
class BusJournal {
 public:
  using Report = std::function<void(bool is_error, const std::string& text)>;

  /// Call once a period of the operator task, in order of time.
  void Follow(std::int64_t now_ns, const std::vector<BusHealth>& buses, const Report& report);

 private:
  struct Reported {
    bool ok = true;
    bool in_fault = false;
    std::string notice{};
    std::uint32_t failed = 0;
    std::int64_t at_ns = INT64_MIN;
  };
  static void FollowDrives(const BusHealth& bus, const Report& report, Reported* reported);

  std::vector<Reported> reported_;
};

}  // namespace flexarm
