#pragma once

#include <filesystem>

#include "config/config.h"

namespace flexarm {

/// Draws the arm from above, to scale, with the elbow at 40 degrees: links, joints, gauges,
/// payload.
void DrawArm(const RigConfig& config, const std::filesystem::path& output);

}  // namespace flexarm
