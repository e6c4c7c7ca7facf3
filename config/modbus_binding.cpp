#include "config/hal_sections.h"
#include "config/line_key.h"

namespace flexarm {
namespace {

void ReadTable(TableReader row, ModbusTable* out) {
  row.Read("table", out,
           {{"coil", ModbusTable::kCoil},
            {"discrete_input", ModbusTable::kDiscreteInput},
            {"holding_register", ModbusTable::kHoldingRegister},
            {"input_register", ModbusTable::kInputRegister}},
           "the table of the device that holds it");
}

void ReadModbusIdentity(TableReader row, ModbusIdentity* out) {
  ReadTable(row, &out->table);
  row.Read("address", &out->address, "as on the wire, from 0");
  row.Read("expected", &out->expected, "its value; another one is another device or setting");
}

void ReadModbusLine(const TableReader& row, ModbusRegister* out) {
  out->role = ModbusRole::kInput;
  out->type = ModbusType::kBit;
  Line line{};
  ReadLine(row, &line);
  out->index = static_cast<int>(line);
}

void ReadModbusStrain(TableReader row, ModbusRegister* out) {
  row.Read("strain", &out->index, "row of [[sensors.strain]] that it reads, from 0");
  row.Read("type", &out->type,
           {{"int16", ModbusType::kInt16},
            {"uint16", ModbusType::kUint16},
            {"int32", ModbusType::kInt32},
            {"float32", ModbusType::kFloat32}},
           "type of the value; the last two take two registers");
  row.Read("word_order", &out->word_order,
           {{"big", ModbusWordOrder::kBig}, {"little", ModbusWordOrder::kLittle}},
           "of 32 bits: which word has the lower address, the more or the less significant");
  row.Read("scale", &out->scale, {"counts of the converter for a value of 1", "counts"});
  row.Read("offset_counts", &out->offset_counts, "counts of the converter for a value of 0");
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
  row.Read("address", &out->address,
           "as on the wire, from 0: 0 where a manual says 30001 or 40001");
  if (row.Has("line")) {
    ReadModbusLine(row, out);
  } else {
    ReadModbusStrain(row, out);
  }
}

void ReadModbusTransport(TableReader row, ModbusDeviceConfig* out) {
  row.Read("transport", &out->transport,
           {{"tcp", ModbusTransport::kTcp}, {"rtu", ModbusTransport::kRtu}},
           "network, with host and port, or serial line, with the five keys after them");
  if (out->transport == ModbusTransport::kTcp) {
    row.Read("host", &out->host, "IPv4 address in digits: the look-up of a name has no time bound");
    row.Read("port", &out->port, "TCP port, usually 502");
    return;
  }
  row.Read("device", &out->device, "the serial line, best by its name in /dev/serial/by-id");
  row.Read("baud", &out->baud, {"rate of the serial line", "bit/s"});
  row.Read(
      "parity", &out->parity,
      {{"none", ModbusParity::kNone}, {"even", ModbusParity::kEven}, {"odd", ModbusParity::kOdd}},
      "parity of the serial line");
  row.Read("data_bits", &out->data_bits, {"of a character", "bits"});
  row.Read("stop_bits", &out->stop_bits, {"of a character", "bits"});
}

}  // namespace

void ReadModbus(TableReader row, double /*period_ms*/, ModbusDeviceConfig* out) {
  row.Read("name", &out->name, "name of the device in messages");
  ReadModbusTransport(row, out);
  row.Read("unit", &out->unit, "unit (slave) address");
  row.Read("response_timeout_ms", &out->response_timeout_ms,
           "longest time in which the device itself answers");
  row.Read("gap_limit", &out->gap_limit,
           {"unused addresses that may be read to save a request", "addresses"});
  for (const TableReader& identity : row.Rows(
           "identification",
           "a register by which the daemon knows that it is this device with these settings")) {
    ReadModbusIdentity(identity, &out->identification.emplace_back());
  }
  for (const TableReader& reading :
       row.Rows("register",
                "a reading: a strain channel, or with `line` a second reading of a safety line")) {
    ReadModbusRegister(reading, &out->map.emplace_back());
  }
}

}  // namespace flexarm
