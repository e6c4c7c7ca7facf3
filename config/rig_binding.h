#pragma once

#include "config/config.h"
#include "config/derivation/arm_scales.h"
#include "config/table_reader.h"

namespace flexarm {

/// Reads every section of a rig into `config`, except its text. Values that cannot be read are
/// reported in the reader's log.
void ReadRig(TableReader root, RigConfig* config);

/// Reads what the derived keys depend on (derivation/arm_scales.h).
void ReadTuningBasis(TableReader root, TuningBasis* basis);

}  // namespace flexarm
