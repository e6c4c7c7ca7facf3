#pragma once

#include "config/config.h"

namespace flexarm {

/// The arm of the check page.
inline ArmParameters ShippedArm() {
  return LoadConfig(FLEXARM_SOURCE_DIR "/config/thesis-rig.toml").arm;
}

}  // namespace flexarm
