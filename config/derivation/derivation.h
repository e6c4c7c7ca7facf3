#pragma once

#include <string>
#include <vector>

#include "config/derivation/arm_scales.h"

namespace flexarm {

/// A key that a config may leave out, with the value that it has then.
struct DerivedValue {
  std::string key;            ///< dotted: "estimator.payload.walk_kg"
  std::vector<double> value;  ///< SI units, or those of the key's name
  bool is_list;               ///< an array in TOML; otherwise one number
  bool is_whole;              ///< one whole number
  std::string how;            ///< where it comes from, in the scales of ArmScales
};

/// Every key that can be derived, in the order of a config file. Numbers have three significant
/// digits.
///
/// Source: docs/theory/derivation.md; found on the arm of the thesis and a few others, checked with
/// arms that were not used for it (tests/config/derivation).
/// @throws std::invalid_argument if the arm has no mode shapes
std::vector<DerivedValue> DeriveTuning(const TuningBasis& basis);

/// DeriveTuning of some arm: keys and texts are the same for every arm.
std::vector<DerivedValue> DeriveSomeArm();

/// The keys of DeriveTuning.
std::vector<std::string> DerivableKeys();

}  // namespace flexarm
