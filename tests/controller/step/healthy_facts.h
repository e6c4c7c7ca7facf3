#pragma once

#include <array>
#include <limits>

#include "controller/step/fault_detection.h"

namespace flexarm {

inline constexpr std::array<int, 2> kGaugesNeeded = {3, 3};

/// Inputs of a healthy arm at rest at zero.
struct Facts {
  DecodedCounters counters{};
  FittedModes modes{};
  StateEstimator::Estimate estimate{};
  std::array<double, 2> torque_nm{};
  std::array<double, 2> model_root_strain{}, root_innovation{};
  std::array<double, 2> reference_hub_rad = {std::numeric_limits<double>::quiet_NaN(),
                                             std::numeric_limits<double>::quiet_NaN()};
  double frame_age_s = 0.0;
  LoopMode mode = LoopMode::kFollow;

  Facts() {
    counters.good = 0b1111;
    modes.valid = {true, true};
    modes.used = 0xFFFFF;
    modes.gauges = {10, 10};
    estimate.x = StateVector::Zero(12);
  }
  LoopFacts Now() const {
    return {.counters = &counters,
            .modes = &modes,
            .estimate = &estimate,
            .model_root_strain = model_root_strain,
            .root_innovation = root_innovation,
            .applied_torque_nm = torque_nm,
            .reference_hub_rad = reference_hub_rad,
            .frame_age_s = frame_age_s,
            .mode = mode};
  }
};

}  // namespace flexarm
