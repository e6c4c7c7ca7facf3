#pragma once

#include "controller/types/step_types.h"
#include "estimator/payload_knowledge.h"

namespace flexarm {

/// The payload as estimated by a step. Real-time: safe.
inline PayloadKnowledge KnownPayload(const StepOutput& output) noexcept {
  return {.payload_kg = output.payload_kg,
          .payload_sigma_kg = output.payload_sigma_kg,
          .friction_nm = output.friction_nm,
          .mean_nis = output.mean_nis,
          .warnings = output.payload_warnings};
}

}  // namespace flexarm
