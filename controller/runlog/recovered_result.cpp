#include "controller/runlog/recovered_result.h"

#include <nlohmann/json.hpp>

#include "controller/runlog/wrapping.h"

namespace flexarm {

void RecoveredResult::Add(const RunRecord& record) {
  if (const auto* block = std::get_if<TicksRecord>(&record)) {
    if (!first_tick_) {
      first_tick_ = block->ticks.front().input.tick;
      first_ns_ = block->ticks.front().input.now_ns;
    }
    last_ns_ = block->ticks.back().input.now_ns;
    last_tick_ = block->ticks.back().input.tick;
    ticks_ += static_cast<std::int64_t>(block->ticks.size());
  }
  if (const auto* safety = std::get_if<SafetyRecord>(&record)) {
    state_ = safety->after.state;
    const bool trips = Trips(*safety);
    if (trips) trip_ = safety->after.cause;
  }
}

std::string RecoveredResult::Json(std::uint64_t left_out_bytes) const {
  const bool tripped = trip_ != TripCause::kNone;
  nlohmann::json result;
  result["completed"] = false;
  result["recovered"] = true;
  result["left_out_bytes"] = left_out_bytes;
  result["trip"] = tripped ? nlohmann::json(ToString(trip_)) : nlohmann::json(nullptr);
  result["ticks"] = ticks_;
  const std::int64_t after_first = WrappedDifference(last_tick_, first_tick_.value_or(last_tick_));
  result["missing_ticks"] = first_tick_ ? WrappedDifference(after_first, ticks_ - 1) : 0;
  result["duration_s"] = static_cast<double>(WrappedDifference(last_ns_, first_ns_)) * 1e-9;
  result["final_state"] = ToString(state_);
  return result.dump();
}

}  // namespace flexarm
