#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "controller/types/messages.h"
#include "controller/types/trip_cause.h"

namespace flexarm {

/// How one bus of a wired rig does, for people.
struct BusHealth {
  std::string name;
  bool ok;
  std::string fault;        ///< what its last exchange met, with device and node; empty: nothing
  std::uint32_t failed;     ///< exchanges that failed, and attempts to reconnect
  std::uint32_t recovered;  ///< how often it was lost and came back
};

/// Tells the journal when a bus is lost or back, and, once a second at most, of exchanges that
/// failed without that. Thread: operator.
class BusJournal {
 public:
  using Report = std::function<void(bool is_error, const std::string& text)>;

  /// Once a period of the operator, in order of time.
  void Follow(std::int64_t now_ns, const std::vector<BusHealth>& buses, const Report& report);

 private:
  struct Told {
    bool ok = true;
    std::uint32_t failed = 0;
    std::int64_t at_ns = INT64_MIN;
  };
  std::vector<Told> told_;
};

}  // namespace flexarm
