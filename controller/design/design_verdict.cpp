#include "controller/design/design_verdict.h"

#include <algorithm>
#include <array>
#include <exception>
#include <limits>
#include <sstream>

namespace flexarm {
namespace {

// Where the required cases are worst, if the loop is unstable there; else "".
std::string WorstCase(const RobustnessAnalysis& robustness) {
  const RobustnessCase& worst = robustness.worst_required();
  if (worst.spectral_radius < 1.0) return {};
  std::ostringstream text;
  text << "; the loop is unstable with " << worst.payload_kg << " kg, elbow at " << worst.theta2_deg
       << " deg, gains x " << worst.gain;
  return text.str();
}

// Adds the checks of the analysis in place of those of their name that a gains file brought, whose
// waivers they keep.
void AddRobustness(const std::vector<DesignCheck>& computed, std::vector<DesignCheck>* checks) {
  for (DesignCheck check : computed) {
    const auto same = std::find_if(checks->begin(), checks->end(),
                                   [&check](const DesignCheck& c) { return c.name == check.name; });
    if (same == checks->end()) {
      checks->push_back(check);
    } else {
      check.waived = same->waived;
      *same = check;
    }
  }
}

}  // namespace

const char* ToString(DesignVerdict::Result result) noexcept {
  switch (result) {
    case DesignVerdict::Result::kSound:
      return "sound";
    case DesignVerdict::Result::kForced:
      return "forced";
    case DesignVerdict::Result::kRejected:
      break;
  }
  return "rejected";
}

std::string CheckText(const DesignCheck& check) {
  std::ostringstream text;
  text << check.name << " = " << check.value << ", must be " << (check.below ? "below " : "above ")
       << check.limit;
  return text.str();
}

std::vector<double> CheckedPayloads_kg(const ControllerConfig& config) {
  constexpr std::array<double, 6> kShares = {0.0, 0.01, 0.1, 0.2, 0.5, 1.0};
  const auto [least, greatest] = config.payload_range_kg;
  std::vector<double> payload_kg;
  for (const double share : kShares) payload_kg.push_back(least + share * (greatest - least));
  return payload_kg;
}

DesignVerdict JudgeDesign(const ControlConfig& config, const Design& design,
                          const std::vector<double>& payload_kg) {
  DesignVerdict verdict{.result = DesignVerdict::Result::kSound,
                        .checks = design.checks,
                        .robustness = std::nullopt,
                        .found = {}};
  std::string where;
  try {
    verdict.robustness = AnalyzeRobustness(config, design, payload_kg);
    AddRobustness(ChecksOf(*verdict.robustness), &verdict.checks);
    where = WorstCase(*verdict.robustness);
  } catch (const std::exception& error) {
    constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
    verdict.checks.push_back({"robustness-spectral-radius", kUnknown, 1.0, true});
    where = std::string("; the robustness analysis is not possible: ") + error.what();
  }
  for (const DesignCheck& check : verdict.checks) {
    if (check.passed()) continue;
    verdict.found += (verdict.found.empty() ? "" : "; ") + CheckText(check);
    if (!check.waived) {
      verdict.result = DesignVerdict::Result::kRejected;
    } else if (verdict.result == DesignVerdict::Result::kSound) {
      verdict.result = DesignVerdict::Result::kForced;
    }
  }
  verdict.found += where;
  return verdict;
}

DesignVerdict JudgeDesign(const ControlConfig& config, const Design& design) {
  return JudgeDesign(config, design, CheckedPayloads_kg(config.controller));
}

}  // namespace flexarm
