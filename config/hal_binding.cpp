#include "config/hal_binding.h"

#include "config/line_key.h"

namespace flexarm {
namespace {

void ReadTable(TableReader row, ModbusTable* out) {
  row.Read("table", out,
           {{"coil", ModbusTable::kCoil},
            {"discrete_input", ModbusTable::kDiscreteInput},
            {"holding_register", ModbusTable::kHoldingRegister},
            {"input_register", ModbusTable::kInputRegister}});
}

void ReadModbusIdentity(TableReader row, ModbusIdentity* out) {
  ReadTable(row, &out->table);
  row.Read("address", &out->address);
  row.Read("expected", &out->expected);
}

// Exactly one of `strain` (row of [[sensors.strain]]) and `line`.
void ReadModbusRole(TableReader row, ModbusRegister* out) {
  if (row.Has("line")) {
    out->role = ModbusRole::kInput;
    Line line{};
    ReadLine(row, &line);
    out->index = static_cast<int>(line);
    return;
  }
  out->role = ModbusRole::kStrain;
  row.Read("strain", &out->index);
}

void ReadModbusRegister(TableReader row, ModbusRegister* out) {
  *out = {.role = ModbusRole::kStrain,
          .index = -1,
          .table = ModbusTable::kInputRegister,
          .address = -1,
          .type = ModbusType::kInt16,
          .word_order = ModbusWordOrder::kBig,
          .scale = 1.0,
          .offset_counts = 0.0};
  ReadModbusRole(row, out);
  ReadTable(row, &out->table);
  row.Read("address", &out->address);
  row.Read("type", &out->type,
           {{"bit", ModbusType::kBit},
            {"int16", ModbusType::kInt16},
            {"uint16", ModbusType::kUint16},
            {"int32", ModbusType::kInt32},
            {"float32", ModbusType::kFloat32}});
  row.Read("word_order", &out->word_order,
           {{"big", ModbusWordOrder::kBig}, {"little", ModbusWordOrder::kLittle}});
  row.Read("scale", &out->scale);
  row.Read("offset_counts", &out->offset_counts);
}

void ReadModbusTransport(TableReader row, ModbusDeviceConfig* out) {
  row.Read("transport", &out->transport,
           {{"tcp", ModbusTransport::kTcp}, {"rtu", ModbusTransport::kRtu}});
  if (out->transport == ModbusTransport::kTcp) {
    row.Read("host", &out->host);
    row.Read("port", &out->port);
    return;
  }
  row.Read("device", &out->device);
  row.Read("baud", &out->baud);
  row.Read(
      "parity", &out->parity,
      {{"none", ModbusParity::kNone}, {"even", ModbusParity::kEven}, {"odd", ModbusParity::kOdd}});
  row.Read("data_bits", &out->data_bits);
  row.Read("stop_bits", &out->stop_bits);
}

void ReadModbus(TableReader row, ModbusDeviceConfig* out) {
  *out = ModbusDeviceConfig{};
  row.Read("name", &out->name);
  ReadModbusTransport(row, out);
  row.Read("unit", &out->unit);
  row.Read("response_timeout_ms", &out->response_timeout_ms);
  row.Read("gap_limit", &out->gap_limit);
  for (const TableReader& identity : row.Rows("identification")) {
    ReadModbusIdentity(identity, &out->identification.emplace_back());
  }
  for (const TableReader& reading : row.Rows("register")) {
    ReadModbusRegister(reading, &out->map.emplace_back());
  }
}

void ReadUnsigned(TableReader row, const char* key, std::uint32_t* out) {
  int value = 0;
  row.Read(key, &value);
  *out = static_cast<std::uint32_t>(value);
}

void ReadNode(TableReader row, CanopenNodeConfig* out) {
  *out = CanopenNodeConfig{};
  row.Read("role", &out->role,
           {{"drive1", CanopenRole::kDrive1},
            {"drive2", CanopenRole::kDrive2},
            {"hub1", CanopenRole::kHub1},
            {"hub2", CanopenRole::kHub2},
            {"rotor1", CanopenRole::kRotor1},
            {"rotor2", CanopenRole::kRotor2}});
  row.Read("node_id", &out->node_id);
  ReadUnsigned(row, "vendor", &out->vendor);
  ReadUnsigned(row, "product", &out->product);
  ReadUnsigned(row, "serial", &out->serial);
  if (!IsDrive(out->role)) return;
  row.Read("torque_per_mille_nm", &out->torque_per_mille_nm);
  row.Read("sign", &out->sign);
  row.Read("torque_range_nm", &out->torque_range_nm);
  row.Read("gear", &out->gear);
  row.Read("position_is_rotor", &out->position_is_rotor);
}

void ReadCanopen(TableReader row, double period_ms, CanopenConfig* out) {
  *out = CanopenConfig{};
  out->period_ms = period_ms;
  row.Read("interface", &out->interface);
  row.Read("bitrate_bps", &out->bitrate_bps);
  row.Read("master_node_id", &out->master_node_id);
  row.Read("answer_timeout_ms", &out->answer_timeout_ms);
  row.Read("sdo_timeout_ms", &out->sdo_timeout_ms);
  row.Read("boot_timeout_ms", &out->boot_timeout_ms);
  row.Read("node_heartbeat_ms", &out->node_heartbeat_ms);
  row.Read("node_timeout_ms", &out->node_timeout_ms);
  row.Read("master_timeout_ms", &out->master_timeout_ms);
  for (const TableReader& node : row.Rows("node")) ReadNode(node, &out->node.emplace_back());
}

void ReadGpiod(TableReader gpiod, GpiodConfig* out) {
  constexpr std::array<const char*, kLines> kKeys = {"limit_1_low",    "limit_1_high",
                                                     "limit_2_low",    "limit_2_high",
                                                     "emergency_stop", "reset_button"};
  gpiod.Read("chip", &out->chip);
  for (std::size_t i = 0; i < kKeys.size(); ++i) gpiod.Read(kKeys[i], &out->input[i]);
  gpiod.Read("relay", &out->relay);
  gpiod.Read("pump", &out->pump);
}

}  // namespace

void ReadHal(TableReader hal, double period_ms, std::string* backend, HalConfig* out) {
  hal.Read<std::string>("backend", backend, {{"sim", "sim"}, {"wired", "wired"}});
  for (const TableReader& row : hal.OptionalRows("modbus")) {
    ReadModbus(row, &out->modbus.device.emplace_back());
  }
  for (const TableReader& row : hal.OptionalRows("canopen")) {
    ReadCanopen(row, period_ms, &out->canopen.emplace_back());
  }
  if (hal.Has("gpiod")) ReadGpiod(hal.Table("gpiod"), &out->gpiod.emplace());
}

}  // namespace flexarm
