#pragma once

#include <sys/types.h>

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "controller/operator/journal_report.h"
#include "controller/operator/peer.h"
#include "controller/runlog/event_queue.h"
#include "controller/types/safety_state.h"

namespace flexarm {

/// One user at a time commands the arm: from the first `arm` that is granted to it until kKeepNs
/// after the relay has opened, by a disarm or a trip. Every process of that user holds the lease.
///
/// Others may ask for `status`, `stop` and `sim`; what else they ask is refused ("held-by"). With
/// "take_over": true the lease becomes theirs, but not while the arm moves. Not real-time safe.
/// Thread: operator.
class Lease {
 public:
  static constexpr std::int64_t kKeepNs = 60'000'000'000;

  /// @param events  to the recorder: one "lease" for each that begins or is taken over; outlives it
  Lease(EventQueue* events, JournalReport report) : events_(events), report_(std::move(report)) {}

  /// Judges a command, and takes the lease over if it says so.
  /// @returns the refusal; null: it may go on
  nlohmann::json Judge(std::int64_t now_ns, const Peer& by, const nlohmann::json& command,
                       SafetyState state);

  /// An `arm` of `by` was granted.
  void Armed(std::int64_t now_ns, const Peer& by);

  /// Once a period: ends the lease in time.
  void Follow(std::int64_t now_ns, SafetyState state);

  /// The user who holds it; empty: it is free.
  std::optional<uid_t> holder() const;

  /// For the status: null, or {"name", "uid", "seconds_left"}; the last is null while the relay is
  /// closed.
  nlohmann::json Json(std::int64_t now_ns) const;

 private:
  void Give(std::int64_t now_ns, const Peer& to, const std::string& how);

  EventQueue* events_;
  JournalReport report_;
  std::optional<Peer> holder_;
  std::int64_t end_ns_ = INT64_MAX;  // INT64_MAX: the relay is closed
};

}  // namespace flexarm
