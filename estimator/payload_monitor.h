#pragma once

#include <cstdint>

#include "estimator/estimator_config.h"
#include "estimator/payload_filter.h"
#include "estimator/payload_knowledge.h"

namespace flexarm {

/// A payload with a standard deviation of this share of estimator.payload.max_kg, or a larger one,
/// counts as unknown: 0.1 kg on the thesis's rig.
inline constexpr double kPayloadUncertain = 1.0 / 11.0;

/// From this mean NIS on, of 8 outputs, the filter's model and so its estimate are wrong.
inline constexpr double kModelWrongNis = 60.0;

/// True if the innovations contradict the filter's model. Real-time: safe.
/// @param mean_nis  as PayloadFilter's
constexpr bool ContradictsModel(double mean_nis) noexcept { return mean_nis > kModelWrongNis; }

/// Monitor of the payload estimate: raises its warnings.
///
/// Bound and model are checked at every sample. Whether a move has made the payload observable is
/// checked once, at its end, and holds until the next one begins: the payload is unknown if its
/// standard deviation is at least kPayloadUncertain of max_kg then. At rest the standard deviation
/// only grows, by the payload's random walk, and does not depend on the move. Real-time: safe.
class PayloadMonitor {
 public:
  explicit PayloadMonitor(const PayloadEstimatorConfig& config) noexcept : max_kg_(config.max_kg) {}

  void Reset() noexcept { moving_ = not_found_ = false; }

  /// To be called every sample, in order.
  /// @param mean_nis  as PayloadFilter's
  /// @param moving    true while the path moves: MotionState
  PayloadKnowledge Judge(const PayloadFilter::Estimate& found, double mean_nis,
                         bool moving) noexcept {
    if (moving) {
      not_found_ = false;
    } else if (moving_) {
      not_found_ = found.payload_sigma_kg >= kPayloadUncertain * max_kg_;
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
