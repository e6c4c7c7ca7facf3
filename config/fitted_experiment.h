#pragma once

#include <string>

#include "config/config.h"

namespace flexarm {

/// A shipped command as a rig can follow it.
struct FittedExperiment {
  Experiment experiment;
  std::string how;  ///< "1.6 times as long, on samples of 8 ms"; "": the command as it is
};

/// A shipped command for any rig. It stays as it is, to the bit, where the rig can follow it; else
/// - its angles shrink until they keep two thirds of the soft angles,
/// - all its times stretch, by one factor, until a rigid arm with the nominal payload needs no more
///   than 70 % of the torques that its joints and links bear and of its rate limits, and until a
///   move without duration_s has 2 s of rest before the next,
/// - its times lie on samples of the loop, and its payloads are the rig's.
///
/// Doublets and moves to angles are fitted; an experiment with another row stays as it is.
/// @throws std::invalid_argument if the arm has no mode shapes
FittedExperiment FitExperiment(const Experiment& experiment, const RigConfig& config);

}  // namespace flexarm
