#pragma once

#include <string>

namespace flexarm {

/// The arm of a user: two links of 0.4 m, steel 25 x 2 mm, one gauge a link, at 50 Hz.
inline const std::string kSteelArm = R"(material = "steel"
link1 = {length_m = 0.4, width_mm = 25, thickness_mm = 2}
link2 = {length_m = 0.4, width_mm = 25, thickness_mm = 2}
joint1 = {torque_limit_nm = 10, encoder_counts_per_turn = 8192}
joint2 = {torque_limit_nm = 3, encoder_counts_per_turn = 8192}
elbow_mass_kg = 1.2
tip_mass_kg = 0.3
gauges_per_link = 1
rate_hz = 50
)";

}  // namespace flexarm
