#pragma once

#include <optional>

#include "controller/operator/arm_verdict.h"
#include "controller/runlog/run_files.h"

namespace flexarm {

/// Why nothing may be armed or run without a log; empty: it may. `files` may be null: no logs.
/// A file that was asked for just now may not be there yet: see LogStatus::answered.
std::optional<UnmetCondition> UnmetLog(const RunFiles* files);

/// "log" of the status; null without logs.
nlohmann::json LogJson(const RunFiles* files);

}  // namespace flexarm
