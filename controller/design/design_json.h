#pragma once

#include <string>

#include "controller/law/design.h"
#include "controller/types/control_config.h"

namespace flexarm {

/// What every gains file has near its start.
inline constexpr const char* kGainsMark = R"("format": "flexarm-gains-)";

/// Digest of all settings of a design: arm, sensors, estimator, controller, period. 16 hex digits.
std::string DesignHash(const ControlConfig& config);

/// A design as JSON text, doubles in 17 digits, with the digest of its config.
std::string DesignToJson(const Design& design, const std::string& config_hash);

/// Reads a design from DesignToJson, with all that the law and the estimator of `config` need.
/// @throws RejectedError naming what is missing or malformed, or that the config was another one
Design DesignFromJson(const std::string& text, const ControlConfig& config);

}  // namespace flexarm
