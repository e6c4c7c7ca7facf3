#pragma once

#include "config/table_reader.h"
#include "hal/sensor_frame.h"

namespace flexarm {

/// Reads the key `line`: a digital line by its name (hal/line_names.h).
void ReadLine(TableReader row, Line* out);

}  // namespace flexarm
