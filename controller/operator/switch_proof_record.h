#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "hal/gpiod/gpiod_config.h"

namespace flexarm {

// The proof of the switches (controller/commissioning/switch_proof.h) as a file of the state
// folder. Pure functions. Not real-time safe. Instants are seconds since 1970, UTC.

/// The file's JSON text: when the switches were proved, and on which lines.
/// @param lines  [hal.gpiod]; empty: the rig is simulated
std::string SwitchProofText(const std::optional<GpiodConfig>& lines, std::int64_t proved_s);

/// Why the text is no proof now, for the person at the rig: it is not one, it is for other lines,
/// older than `valid_days`, or from the future. "" if it is one. Never throws.
std::string WhyNoProof(const std::string& text, const std::optional<GpiodConfig>& lines,
                       double valid_days, std::int64_t now_s);

}  // namespace flexarm
