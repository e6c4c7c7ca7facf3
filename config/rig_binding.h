#pragma once

#include "config/config.h"
#include "config/table_reader.h"

namespace flexarm {

/// Reads every section of a rig into `config`, except its text. Values that cannot be read are
/// reported in the reader's log.
void ReadRig(TableReader root, RigConfig* config);

}  // namespace flexarm
