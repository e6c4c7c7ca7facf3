#include "controller/health/health_report.h"

namespace flexarm {

std::vector<std::string> HealthReport::AlarmedKeys() const {
  std::vector<std::string> keys;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    if (Alarmed(i)) keys.push_back(channels[i].Key());
  }
  return keys;
}

std::vector<std::string> HealthReport::AlarmTexts() const {
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    if (Alarmed(i)) texts.push_back(AlarmText(channels[i], trends[i]));
  }
  return texts;
}

HealthReport ReportOf(const ControlConfig& config, const HealthConfig& health,
                      const HealthHistory& history) {
  HealthReport report{.channels = DriftChannels(config.arm, config.sensors), .trends = {}};
  const std::vector<DriftScale> scales = ScalesOf(report.channels, config.arm, config.sensors);
  report.trends = DriftTrends(report.channels, scales, history);
  for (std::size_t i = 0; i < report.channels.size(); ++i) {
    if (health.judge_payload || report.channels[i].kind != DriftKind::kPayload) continue;
    report.trends[i].verdict = DriftVerdict::kUnknown;
  }
  return report;
}

}  // namespace flexarm
