#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "controller/design/robustness_analysis.h"
#include "controller/law/design.h"
#include "controller/types/control_config.h"

namespace flexarm {

/// Whether a design may control the arm: the one verdict of `flexarm design`, of `simulate`, and of
/// the daemon before it arms.
struct DesignVerdict {
  enum class Result : std::uint8_t {
    kSound,     ///< every check passed
    kForced,    ///< checks failed, and each was waived with `flexarm design --force`
    kRejected,  ///< a check failed that was not waived
  };

  Result result;
  std::vector<DesignCheck> checks;  ///< those of the design, then those of the robustness analysis
  std::optional<RobustnessAnalysis> robustness;  ///< nothing: it could not be computed
  /// The checks that failed with value and limit, and the worst case: "" if the design is sound.
  std::string found;

  /// LoopMargins::delay_s; 0 if unknown.
  double delay_margin_s() const { return robustness ? robustness->margins.delay_s : 0.0; }
};

/// "sound", "forced" or "rejected".
const char* ToString(DesignVerdict::Result result) noexcept;

/// "gain-margin-up = 1.2, must be above 1.4".
std::string CheckText(const DesignCheck& check);

/// Payloads with which the loop is checked, kg: the bounds of controller.payload_range_kg, and
/// between them 1, 10, 20 and 50 % of the way.
std::vector<double> CheckedPayloads_kg(const ControllerConfig& config);

/// Judges a design for its config. The robustness analysis is computed again for the gains as they
/// are; what a gains file says of it counts only for which of its checks are waived. Takes a
/// quarter of a second. Not real-time safe. Never throws for a design that cannot be analysed:
/// rejected.
/// @param payload_kg  as for AnalyzeRobustness
DesignVerdict JudgeDesign(const ControlConfig& config, const Design& design,
                          const std::vector<double>& payload_kg);

/// For the payloads of the config.
DesignVerdict JudgeDesign(const ControlConfig& config, const Design& design);

}  // namespace flexarm
