#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "controller/health/health_history.h"
#include "controller/health/health_report.h"

namespace flexarm {

/// What `flexarm health` shows.
struct ShownHealth {
  HealthReport report;
  HealthHistory history;
  std::optional<RunFigures> newest;  ///< of the newest run, if its log was read
};

/// Columns: channel, figure of the newest run with its standard error, change against the
/// reference, slope, verdict; then the runs that were left out, the residuals, and a sentence for
/// each alarm.
std::string HealthText(const ShownHealth& health);

/// The same as JSON: docs/health.md.
nlohmann::ordered_json HealthJson(const ShownHealth& health);

}  // namespace flexarm
