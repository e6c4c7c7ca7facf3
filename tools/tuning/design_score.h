#pragma once

#include "config/config.h"
#include "controller/design/design_verdict.h"

namespace flexarm {

/// How far a design is from the limits of its robustness checks, and from comfortable ones.
struct DesignScore {
  /// 0: a check fails or just passes; 1: each passes with room: the slowest required case decays at
  /// 0.5 1/s, the gains may double, 8 ms of delay may be added. Negative: a check fails, by how
  /// much; -10: there is no design.
  double value;
  DesignVerdict::Result result;
  std::string found;  ///< as DesignVerdict's
};

/// Designs and judges. Never throws for a config that has no design.
DesignScore ScoreOf(const RigConfig& config);

}  // namespace flexarm
