#pragma once

#include "config/derivation/derived_list.h"

namespace flexarm {

// The parts of DeriveTuning, one a section of the config.
void DeriveTiming(const TuningBasis& basis, DerivedList* out);
void DeriveEstimator(const TuningBasis& basis, const ArmScales& scales, DerivedList* out);
void DerivePayloadFilter(const TuningBasis& basis, const ArmScales& scales, DerivedList* out);
void DeriveController(const TuningBasis& basis, const ArmScales& scales, DerivedList* out);
void DeriveLimits(const TuningBasis& basis, const ArmScales& scales, DerivedList* out);

/// Limit of the hub rates, rad/s.
std::array<double, 2> HubRateLimit_rad_s(const ArmScales& scales);

}  // namespace flexarm
