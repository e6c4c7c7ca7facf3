#include "tools/tuning/design_score.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <map>
#include <string>

#include "controller/design/design_controller.h"

namespace flexarm {
namespace {

constexpr double kNoDesign = -10.0;

// Values of the margins with room.
constexpr double kRoomDecay_per_s = 0.5;
const std::map<std::string, double> kRoom = {
    {"gain-margin-up", 2.0}, {"gain-margin-down", 0.5}, {"delay-margin-ms", 8.0}};

// The least of the shares of the way from a check's limit to its value with room.
double RobustnessScore(const RobustnessAnalysis& robustness, double period_s) {
  const double radius = robustness.worst_required().spectral_radius;
  if (!std::isfinite(radius)) return kNoDesign;
  double least = std::min(1.0, -std::log(std::max(radius, 1e-6)) / period_s / kRoomDecay_per_s);
  for (const DesignCheck& check : ChecksOf(robustness)) {
    const auto room = kRoom.find(check.name);
    if (room == kRoom.end()) continue;
    least = std::min(least, (check.value - check.limit) / (room->second - check.limit));
  }
  return std::max(least, kNoDesign);
}

}  // namespace

DesignScore ScoreOf(const RigConfig& config) {
  try {
    const Design design = DesignController(config);
    const DesignVerdict verdict = JudgeDesign(config, design);
    DesignScore score{.value = kNoDesign, .result = verdict.result, .found = verdict.found};
    if (!verdict.robustness) return score;
    score.value = RobustnessScore(*verdict.robustness, config.loop.period_s());
    if (verdict.result == DesignVerdict::Result::kRejected)
      score.value = std::min(score.value, 0.0);
    for (const DesignCheck& check : verdict.checks) {
      if (!check.passed() && !IsRobustnessCheck(check.name)) score.value -= 1.0;
    }
    return score;
  } catch (const std::exception& error) {
    return {.value = kNoDesign, .result = DesignVerdict::Result::kRejected, .found = error.what()};
  }
}

}  // namespace flexarm
