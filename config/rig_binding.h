#pragma once

#include "config/config.h"
#include "config/table_reader.h"

namespace flexarm {

/// Reads every section of a rig into `config`, all but its text. What cannot be read goes into the
/// reader's log.
void ReadRig(TableReader root, RigConfig* config);

}  // namespace flexarm
