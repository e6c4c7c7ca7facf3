#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "controller/runlog/record_format.h"

namespace flexarm {

/// The result of a run whose program was killed, as far as its records tell it.
class RecoveredResult {
 public:
  void Add(const RunRecord& record);

  /// JSON with the keys of a result, `recovered` true, and `left_out_bytes`.
  std::string Json(std::uint64_t left_out_bytes) const;

 private:
  std::optional<std::int64_t> first_tick_;
  std::int64_t last_tick_ = 0;
  std::int64_t first_ns_ = 0, last_ns_ = 0;
  std::int64_t ticks_ = 0;
  SafetyState state_ = SafetyState::kIdle;
  TripCause trip_ = TripCause::kNone;
};

}  // namespace flexarm
