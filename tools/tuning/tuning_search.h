#pragma once

#include <functional>
#include <string>
#include <vector>

#include "config/config.h"
#include "tools/tuning/design_score.h"

namespace flexarm {

/// A key that the search changed.
struct TunedKey {
  std::string key;
  std::string before, after;  ///< as TOML
};

struct Tuning {
  std::vector<TunedKey> changed;  ///< empty: nothing better was found
  DesignScore before, after;
  RigConfig config;  ///< with the changes
};

/// Searches noises and weights for the best margins over payloads and elbow angles: a pattern
/// search over common factors of the process noises, the noise of the modal coordinates and of the
/// hub encoders, torque_weight, hub_rate_weight and alpha.
///
/// Ends when every margin has room (DesignScore of 1), or nothing helps. Deterministic. At most
/// `most` designs, a tenth of a second each.
/// @param progress  called with the designs done and the best score so far; may be empty
Tuning TuneDesign(const RigConfig& config, int most,
                  const std::function<void(int, double)>& progress = {});

/// Why no tuning helps this rig: a mode above half the sampling rate, a slow gauge filter, a coarse
/// gauge or encoder, each with what would help; or that none of these is the case.
std::vector<std::string> ObstaclesOf(const RigConfig& config);

}  // namespace flexarm
