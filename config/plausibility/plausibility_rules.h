#pragma once

#include <string>
#include <vector>

#include "config/plausibility/plausibility.h"
#include "controller/types/control_config.h"

namespace flexarm {

/// Each rule judges a valid config by itself. The limits stand beside the rule.
using ImplausibleValueList = std::vector<ImplausibleValue>;

/// Links of millimetres or of kilometres: a length in another unit.
ImplausibleValueList JudgeLinkLengths(const ControlConfig& config);
/// Young's modulus and density that no material of a link has.
ImplausibleValueList JudgeMaterials(const ControlConfig& config);
/// Half thickness that does not go with area and second moment: I = A (2c)^2 / 12 for a rectangle.
ImplausibleValueList JudgeThickness(const ControlConfig& config);
/// Damping ratio of a link that hardly vibrates.
ImplausibleValueList JudgeDamping(const ControlConfig& config);
/// Joint that the torque limit twists by many degrees.
ImplausibleValueList JudgeJointTwist(const ControlConfig& config);

/// Encoder of which one count moves the tip visibly.
ImplausibleValueList JudgeEncoders(const ControlConfig& config);
/// Gauge that a bent link moves by a few counts only.
ImplausibleValueList JudgeGaugeSignals(const ControlConfig& config);
/// Gauges of a link that read the same mixture of the fitted modes.
ImplausibleValueList JudgeGaugePlaces(const ControlConfig& config);
/// Modes of the nominal model above half the sampling rate.
ImplausibleValueList JudgeSamplingRate(const ControlConfig& config);

/// Torque limit of which friction takes most.
ImplausibleValueList JudgeFrictionTorques(const ControlConfig& config);
/// Torque limit far above what bends the link to its strain limit.
ImplausibleValueList JudgeBendingTorques(const ControlConfig& config);
/// Strain limit that metals do not survive, or that every motion exceeds.
ImplausibleValueList JudgeStrainLimits(const ControlConfig& config);

/// A figure of a message, with three digits.
std::string ShortNumber(double value);

}  // namespace flexarm
