#pragma once

#include <string>
#include <vector>

#include "hal/bus_device.h"
#include "hal/modbus/modbus_config.h"

// Devices for the tests of this folder.

namespace flexarm {

/// Command to a device without drives.
inline constexpr BusCommand kDrivesOff{.torque_nm = {}, .enabled = false};

inline ModbusRegister StrainRow(int index, int address, ModbusType type = ModbusType::kInt16,
                                ModbusWordOrder order = ModbusWordOrder::kBig) {
  return {.role = ModbusRole::kStrain,
          .index = index,
          .table = ModbusTable::kInputRegister,
          .address = address,
          .type = type,
          .word_order = order,
          .scale = 1.0,
          .offset_counts = 0.0};
}

inline ModbusRegister InputRow(Line line, int address,
                               ModbusTable table = ModbusTable::kDiscreteInput) {
  return {.role = ModbusRole::kInput,
          .index = static_cast<int>(line),
          .table = table,
          .address = address,
          .type = ModbusType::kBit,
          .word_order = ModbusWordOrder::kBig,
          .scale = 1.0,
          .offset_counts = 0.0};
}

/// Unit 1 with ten strain gauges in int16 from input register 0 on, one reset button, and two
/// holding registers for its identification: two requests a period, or three with identity check.
inline ModbusDeviceConfig Amplifier() {
  ModbusDeviceConfig device{
      .name = "amplifier",
      .transport = ModbusTransport::kTcp,
      .host = "127.0.0.1",
      .port = 1502,
      .device = "",
      .baud = 115200,
      .parity = ModbusParity::kEven,
      .data_bits = 8,
      .stop_bits = 1,
      .unit = 1,
      .response_timeout_ms = 5.0,
      .gap_limit = 4,
      .identification = {{.table = ModbusTable::kHoldingRegister,
                          .address = 100,
                          .expected = 0x4142},
                         {.table = ModbusTable::kHoldingRegister, .address = 101, .expected = 7}},
      .map = {}};
  for (int i = 0; i < 10; ++i) device.map.push_back(StrainRow(i, i));
  device.map.push_back(InputRow(Line::kResetButton, 16));
  return device;
}

/// The same on a serial line.
inline ModbusDeviceConfig SerialAmplifier(const std::string& path) {
  ModbusDeviceConfig device = Amplifier();
  device.transport = ModbusTransport::kRtu;
  device.device = path;
  return device;
}

}  // namespace flexarm
