#pragma once

#include <array>
#include <cstdint>

namespace flexarm {

/// What the estimator has found of the arm, and what is wrong with it.
struct PayloadKnowledge {
  double payload_kg, payload_sigma_kg;
  std::array<double, 2> friction_nm;
  double mean_nis;         ///< 8 for a right model
  std::uint32_t warnings;  ///< PayloadWarningBit
};

}  // namespace flexarm
