#pragma once

#include <array>
#include <cstdint>
#include <limits>

namespace flexarm {

/// Warnings of the payload estimate. Bits, logged as StepOutput::payload_warnings.
enum PayloadWarningBit : std::uint32_t {
  kPayloadAtBound = 1,        ///< the estimate is at its upper bound
  kPayloadModelMismatch = 2,  ///< the innovations are far larger than model and noise explain
  kPayloadNotObservable = 4,  ///< a move has ended without reducing the uncertainty
};

/// Payload and friction estimates of the observer, with their warnings.
struct PayloadKnowledge {
  double payload_kg, payload_sigma_kg;
  std::array<double, 2> friction_nm;
  double mean_nis;         ///< 8 for a right model
  std::uint32_t warnings;  ///< PayloadWarningBit
};

/// Value of a quantity that an observer does not estimate.
inline constexpr double kNotEstimated = std::numeric_limits<double>::quiet_NaN();
/// Result of an observer that does not estimate the payload.
inline constexpr PayloadKnowledge kNoPayloadEstimate = {
    .payload_kg = kNotEstimated,
    .payload_sigma_kg = kNotEstimated,
    .friction_nm = {kNotEstimated, kNotEstimated},
    .mean_nis = kNotEstimated,
    .warnings = 0};

}  // namespace flexarm
