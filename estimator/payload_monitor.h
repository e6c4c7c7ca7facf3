#pragma once

#include <cstdint>

#include "estimator/estimator_config.h"
#include "estimator/payload_filter.h"
#include "estimator/payload_knowledge.h"

namespace flexarm {

/// A payload with this standard deviation, or a greater one, is as good as unknown.
inline constexpr double kPayloadUncertain_kg = 0.1;

/// From this mean NIS on, of 8 outputs, the filter's model is wrong, and what it finds with it.
inline constexpr double kModelWrongNis = 60.0;

/// The sensors say that the filter's model is wrong. Real-time: safe.
/// @param mean_nis  as PayloadFilter's
inline constexpr bool ContradictsModel(double mean_nis) noexcept {
  return mean_nis > kModelWrongNis;
}

/// Judges the payload that is found.
///
/// Bound and model are judged anew at every sample. Whether a move has shown the payload is judged
/// once, when it ends, and holds until the next one begins: a payload that is as good as unknown
/// then (kPayloadUncertain_kg). At rest the standard deviation only grows, by the payload's walk,
/// and says nothing about the move. Real-time: safe.
class PayloadMonitor {
 public:
  explicit PayloadMonitor(const PayloadEstimatorConfig& config) noexcept : max_kg_(config.max_kg) {}

  void Reset() noexcept { moving_ = not_found_ = false; }

  /// Every sample, in order.
  /// @param mean_nis  as PayloadFilter's
  /// @param moving    whether the path does: MotionState
  PayloadKnowledge Judge(const PayloadFilter::Estimate& found, double mean_nis,
                         bool moving) noexcept {
    if (moving) {
      not_found_ = false;
    } else if (moving_) {
      not_found_ = found.payload_sigma_kg >= kPayloadUncertain_kg;
    }
    moving_ = moving;
    std::uint32_t warnings = 0;
    if (found.payload_kg >= max_kg_) warnings |= kPayloadAtBound;
    if (ContradictsModel(mean_nis)) warnings |= kPayloadModelMismatch;
    if (not_found_) warnings |= kPayloadNotObservable;
    return {.payload_kg = found.payload_kg,
            .payload_sigma_kg = found.payload_sigma_kg,
            .friction_nm = found.friction_nm,
            .mean_nis = mean_nis,
            .warnings = warnings};
  }

 private:
  double max_kg_;
  bool moving_ = false, not_found_ = false;
};

}  // namespace flexarm
