#include "config/hal_binding.h"

#include <array>
#include <memory>

#include "config/line_key.h"
#include "hal/canopen/canopen_wiring.h"
#include "hal/comedi/comedi_wiring.h"
#include "hal/modbus/modbus_wiring.h"

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

void ReadModbusLine(const TableReader& row, ModbusRegister* out) {
  out->role = ModbusRole::kInput;
  out->type = ModbusType::kBit;
  Line line{};
  ReadLine(row, &line);
  out->index = static_cast<int>(line);
}

void ReadModbusStrain(TableReader row, ModbusRegister* out) {
  row.Read("strain", &out->index);
  row.Read("type", &out->type,
           {{"int16", ModbusType::kInt16},
            {"uint16", ModbusType::kUint16},
            {"int32", ModbusType::kInt32},
            {"float32", ModbusType::kFloat32}});
  row.Read("word_order", &out->word_order,
           {{"big", ModbusWordOrder::kBig}, {"little", ModbusWordOrder::kLittle}});
  row.Read("scale", &out->scale);
  row.Read("offset_counts", &out->offset_counts);
}

// Exactly one of `strain` (row of [[sensors.strain]]) and `line`.
void ReadModbusRegister(TableReader row, ModbusRegister* out) {
  *out = {.role = ModbusRole::kStrain,
          .index = -1,
          .table = ModbusTable::kInputRegister,
          .address = -1,
          .type = ModbusType::kInt16,
          .word_order = ModbusWordOrder::kBig,
          .scale = 1.0,
          .offset_counts = 0.0};
  ReadTable(row, &out->table);
  row.Read("address", &out->address);
  if (row.Has("line")) {
    ReadModbusLine(row, out);
  } else {
    ReadModbusStrain(row, out);
  }
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

void ReadModbus(TableReader row, double /*period_ms*/, ModbusDeviceConfig* out) {
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

// The role of a drive or of an encoder, with the same names as on the other buses.
void ReadJoint(TableReader row, int* out) { row.Read("role", out, {{"drive1", 0}, {"drive2", 1}}); }
void ReadCounter(TableReader row, int* out) {
  row.Read("role", out, {{"hub1", 0}, {"hub2", 1}, {"rotor1", 2}, {"rotor2", 3}});
}

void ReadComediInput(TableReader input, ComediInputConfig* out) {
  input.Read("subdevice", &out->subdevice);
  input.Read("channels", &out->channels);
  input.Read("bits", &out->bits);
  input.Read("range_v", &out->range_v);
  input.Read("reference", &out->reference,
             {{"ground", ComediReference::kGround},
              {"common", ComediReference::kCommon},
              {"differential", ComediReference::kDifferential}});
  input.Read("acquisition", &out->acquisition,
             {{"stream", ComediAcquisition::kStream}, {"single", ComediAcquisition::kSingle}});
  if (out->acquisition == ComediAcquisition::kStream) {
    input.Read("scan_interval_us", &out->scan_interval_us);
    input.Read("convert_interval_us", &out->convert_interval_us);
    input.Read("transfer_us", &out->transfer_us);
  }
  for (TableReader& row : input.Rows("channel")) {
    ComediStrainConfig& channel = out->channel.emplace_back();
    row.Read("strain", &channel.strain);
    row.Read("channel", &channel.channel);
  }
}

void ReadComediOutput(TableReader output, ComediOutputConfig* out) {
  output.Read("subdevice", &out->subdevice);
  output.Read("channels", &out->channels);
  output.Read("bits", &out->bits);
  output.Read("range_v", &out->range_v);
  for (TableReader& row : output.Rows("drive")) {
    ComediDriveConfig& drive = out->drive.emplace_back();
    ReadJoint(row, &drive.joint);
    row.Read("channel", &drive.channel);
    row.Read("motor_torque_per_volt_nm", &drive.motor_torque_per_volt_nm);
    row.Read("gear", &drive.gear);
    row.Read("sign", &drive.sign);
    row.Read("torque_range_nm", &drive.torque_range_nm);
  }
}

void ReadComedi(TableReader row, double period_ms, ComediBoardConfig* out) {
  out->period_ms = period_ms;
  row.Read("device", &out->device);
  row.Read("driver", &out->driver);
  row.Read("board", &out->board);
  row.Read("instruction_us", &out->instruction_us);
  if (row.Has("input")) ReadComediInput(row.Table("input"), &out->input.emplace());
  if (row.Has("output")) ReadComediOutput(row.Table("output"), &out->output.emplace());
  for (TableReader& entry : row.OptionalRows("counter")) {
    ComediCounterConfig& counter = out->counter.emplace_back();
    ReadCounter(entry, &counter.counter);
    entry.Read("subdevice", &counter.subdevice);
    entry.Read("channel", &counter.channel);
    entry.Read("bits", &counter.bits);
  }
  for (TableReader& entry : row.OptionalRows("line")) {
    ComediLineConfig& line = out->line.emplace_back();
    ReadLine(entry, &line.line);
    entry.Read("subdevice", &line.subdevice);
    entry.Read("channel", &line.channel);
  }
}

void ReadGpiod(TableReader gpiod, GpiodConfig* out) {
  constexpr std::array<const char*, kLines> kKeys = {"limit_1_low",    "limit_1_high",
                                                     "limit_2_low",    "limit_2_high",
                                                     "emergency_stop", "reset_button"};
  gpiod.Read("chip", &out->chip);
  for (std::size_t i = 0; i < kKeys.size(); ++i) gpiod.Read(kKeys[i], &out->input[i]);
  gpiod.Read("relay", &out->relay);
  gpiod.Read("pump", &out->pump);
  if (gpiod.Has("drive_voltage")) {
    TableReader voltage = gpiod.Table("drive_voltage");
    DriveVoltageTimes& times = out->drive_voltage.emplace();
    voltage.Read("rise_ms", &times.rise_ms);
    voltage.Read("fall_ms", &times.fall_ms);
  }
  if (gpiod.Has("relay_contact")) gpiod.Read("relay_contact", &out->relay_contact.emplace());
}

// A bus from its row, by a function that reads the keys of its config.
template <typename Wiring, void (*read)(TableReader, double, typename Wiring::Config*)>
std::shared_ptr<const BusWiring> ReadBus(const TableReader& row, double period_ms) {
  typename Wiring::Config config{};
  read(row, period_ms, &config);
  return std::make_shared<Wiring>(std::move(config));
}

struct BusKind {
  const char* key;  // of [hal], and BusWiring::kind
  std::shared_ptr<const BusWiring> (*read)(const TableReader& row, double period_ms);
};

// Every kind of bus, in the order in which the rig opens them.
constexpr std::array kBusKinds = {
    BusKind{"canopen", ReadBus<CanopenWiring, ReadCanopen>},
    BusKind{"modbus", ReadBus<ModbusWiring, ReadModbus>},
    BusKind{"comedi", ReadBus<ComediWiring, ReadComedi>},
};

}  // namespace

void ReadHal(TableReader hal, double period_ms, std::string* backend, HalConfig* out) {
  hal.Read<std::string>("backend", backend, {{"sim", "sim"}, {"wired", "wired"}});
  for (const BusKind& kind : kBusKinds) {
    for (const TableReader& row : hal.OptionalRows(kind.key)) out->Add(kind.read(row, period_ms));
  }
  if (hal.Has("gpiod")) ReadGpiod(hal.Table("gpiod"), &out->gpiod.emplace());
}

}  // namespace flexarm
