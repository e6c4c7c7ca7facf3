#pragma once

#include "controller/law/design.h"
#include "controller/runlog/replay.h"
#include "controller/runlog/run_reader.h"
#include "controller/types/rig_config.h"

namespace flexarm {

/// The gains that a log holds, for the config of the replay.
/// @throws InputError if they cannot be read, or are not of this config
Design GainsOf(const RunReader& reader, const RigConfig& config);

/// Runs all samples and safety records of a log through a new loop. Holds one sample at a time.
/// @param other_config  `config` is not the log's own: bytes are not compared
/// With the observer `ideal`, the state of each record is the true one.
/// @throws InputError as RunReader
ReplayResult ReplayLog(RunReader* reader, const RigConfig& config, const Design& design,
                       bool other_config);

}  // namespace flexarm
