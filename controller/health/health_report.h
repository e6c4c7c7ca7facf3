#pragma once

#include <string>
#include <vector>

#include "controller/health/drift_trend.h"
#include "controller/health/health_history.h"
#include "controller/types/control_config.h"
#include "controller/types/health_config.h"

namespace flexarm {

/// The health of a rig after its newest run.
struct HealthReport {
  std::vector<DriftChannel> channels;
  std::vector<DriftTrend> trends;  ///< of the channels

  bool Alarmed(std::size_t channel) const {
    return trends[channel].verdict == DriftVerdict::kDrifts;
  }
  /// Keys of the channels with an alarm.
  std::vector<std::string> AlarmedKeys() const;
  /// A sentence for each of them, in the same order.
  std::vector<std::string> AlarmTexts() const;
};

/// Trends of the channels that the config lets judge.
HealthReport ReportOf(const ControlConfig& config, const HealthConfig& health,
                      const HealthHistory& history);

}  // namespace flexarm
