#pragma once

#include <string>
#include <vector>

#include "config/config.h"
#include "controller/design/design_controller.h"
#include "controller/law/design.h"
#include "controller/reference/motion_limits.h"

namespace flexarm {

/// The rig of config/hil.toml: golden.json is for this rig.
inline RigConfig ShippedRig(const std::vector<std::string>& overrides = {}) {
  return LoadConfig(FLEXARM_SOURCE_DIR "/config/hil.toml", overrides);
}

/// The thesis's law, without what `sobel` adds at rest.
inline constexpr const char* kThesisLaw = "controller.name=sobel-thesis";

/// Its design, computed once.
inline const Design& ShippedDesign() {
  static const Design design = DesignController(ShippedRig());
  return design;
}

/// Its design for a law that follows a path, computed once.
inline const Design& ShippedPathDesign() {
  static const Design design = DesignController(ShippedRig({"controller.name=gain-scheduled"}));
  return design;
}

/// The limits of its references.
inline const MotionLimits& ShippedLimits() {
  static const MotionLimits limits = MotionLimitsOf(ShippedRig());
  return limits;
}

}  // namespace flexarm
