#pragma once

#include <cstdint>

#include "controller/law/scheduling_payload.h"
#include "controller/types/payload_knowledge.h"
#include "controller/types/step_types.h"
#include "estimator/estimator_config.h"
#include "estimator/payload_filter.h"

namespace flexarm {

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
