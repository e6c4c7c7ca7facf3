#pragma once

#include <Eigen/Core>
#include <vector>

#include "controller/law/design.h"

namespace flexarm {

struct ControlConfig;

/// One case of the robustness analysis: the whole loop, linear and without friction.
struct RobustnessCase {
  double payload_kg;
  double theta2_deg;       ///< elbow angle of the linearised plant
  double gain;             ///< factor on the law's feedback
  double spectral_radius;  ///< of the closed loop over one period: stable below 1
  bool required;           ///< the design must be stable in this case
};

/// Gain and delay margins with the payload of the design, elbow straight.
struct LoopMargins {
  double gain_up;    ///< least factor > 1 on the feedback that makes it unstable; 100: none found
  double gain_down;  ///< greatest factor < 1; 0: none found
  double delay_s;    ///< least additional delay that makes it unstable; 0.1: none found
};

struct RobustnessAnalysis {
  std::vector<RobustnessCase> cases;
  LoopMargins margins;

  const RobustnessCase& worst() const;           ///< of all cases, the largest spectral radius
  const RobustnessCase& worst_required() const;  ///< of the cases in which a design must be stable
};

/// Robustness analysis: closes the loop around plants other than the nominal one, at rest: the arm
/// with four modes a link and elastic joints at elbow angles of 0, 45 and 90 degrees, with each
/// payload, gauge filter, strain fit, estimator, prediction and the sample of delay; gains times 1,
/// 0.7 and 1.4.
///
/// A law that follows the payload enters with the model, filter and gains of the payload and elbow
/// angle of each case (design_at_payload.h): it has found the payload. While it has not, neither
/// this analysis nor another linear one applies; docs/theory/payload.md 6 has what was simulated.
///
/// Linear: no friction, quantisation or limits. An adaptive law enters with its initial gains,
/// which adaptation can raise by a factor of at most 1 + 1/G. Positive realness of the nominal
/// model says nothing about modes that it does not contain, but this analysis includes them
/// (docs/theory/control-law.md 10).
///
/// A design must be stable for every payload with its own gains, and for its own payload with the
/// gains x 0.7 and x 1.4. Other combinations are only reported: no design with alpha >= 1 is stable
/// for 0 kg at 90 degrees with gains x 1.4; the shipped one has 1.020 there (an oscillation that
/// doubles in 0.7 s and is bounded by friction, which is neglected here).
/// @param payload_kg  payloads of interest, each >= 0; the design's own is added
/// @throws std::runtime_error if the arm has no linear model
RobustnessAnalysis AnalyzeRobustness(const ControlConfig& config, const Design& design,
                                     const std::vector<double>& payload_kg);

/// The results as checks of the design: "robustness-spectral-radius", "gain-margin-up",
/// "gain-margin-down", "delay-margin-ms".
std::vector<DesignCheck> ChecksOf(const RobustnessAnalysis& robustness);

/// Whether ChecksOf gives a check of this name.
bool IsRobustnessCheck(const std::string& name);

}  // namespace flexarm
