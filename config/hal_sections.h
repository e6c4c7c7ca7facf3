#pragma once

#include "config/table_reader.h"
#include "hal/canopen/canopen_config.h"
#include "hal/comedi/comedi_config.h"
#include "hal/modbus/modbus_config.h"

namespace flexarm {

// The rows of each kind of bus, read by the file that is named after the kind.

/// A row [[hal.canopen]]. @param period_ms  of the loop; the buses run at the same period
void ReadCanopen(TableReader row, double period_ms, CanopenConfig* out);
/// A row [[hal.modbus]].
void ReadModbus(TableReader row, double period_ms, ModbusDeviceConfig* out);
/// A row [[hal.comedi]].
void ReadComedi(TableReader row, double period_ms, ComediBoardConfig* out);

}  // namespace flexarm
