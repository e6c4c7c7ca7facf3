#include "tools/tuning/design_score.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>

#include "controller/design/design_controller.h"

namespace flexarm {
namespace {

constexpr double kNoDesign = -10.0;

// Limits of the checks, and values with room.
constexpr double kRoomDecay_per_s = 0.5;
constexpr double kGainUp = 1.4, kRoomGainUp = 2.0;
constexpr double kGainDown = 0.7, kRoomGainDown = 0.5;
constexpr double kDelay_ms = 4.0, kRoomDelay_ms = 8.0;

double Share(double value, double limit, double room) { return (value - limit) / (room - limit); }

double RobustnessScore(const RobustnessAnalysis& robustness, double period_s) {
  const double radius = robustness.worst_required().spectral_radius;
  if (!std::isfinite(radius)) return kNoDesign;
  const LoopMargins& margins = robustness.margins;
  const std::array<double, 4> shares = {
      -std::log(std::max(radius, 1e-6)) / period_s / kRoomDecay_per_s,
      Share(margins.gain_up, kGainUp, kRoomGainUp),
      Share(margins.gain_down, kGainDown, kRoomGainDown),
      Share(1e3 * margins.delay_s, kDelay_ms, kRoomDelay_ms)};
  double least = 1.0;
  for (const double share : shares) least = std::min(least, share);
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
