#pragma once

#include <string>

#include "controller/law/design.h"
#include "controller/types/control_config.h"

namespace flexarm {

/// Digest of what a design depends on: arm, sensors, estimator, controller, period. 16 hex digits.
std::string DesignHash(const ControlConfig& config);

/// A design as JSON text, doubles in 17 digits, with the digest of its config.
std::string DesignToJson(const Design& design, const std::string& config_hash);

/// Reads what DesignToJson wrote, with all that the laws and the estimator of `config` need.
/// @throws Refused naming what is missing or misshapen, or that it was designed for another config
Design DesignFromJson(const std::string& text, const ControlConfig& config);

}  // namespace flexarm
