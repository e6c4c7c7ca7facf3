#pragma once

#include <nlohmann/json_fwd.hpp>

#include "controller/types/step_types.h"

namespace flexarm {

/// The payload estimate of one step, for status and log; null if the estimator finds none. Units
/// as in StepOutput: kg, Nm. Pure function. Not real-time safe.
nlohmann::json PayloadJson(const StepInput& input, const StepOutput& output);

}  // namespace flexarm
