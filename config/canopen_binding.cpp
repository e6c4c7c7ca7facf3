#include "config/hal_sections.h"

namespace flexarm {
namespace {

void ReadUnsigned(TableReader row, const char* key, std::uint32_t* out, const Meaning& meaning) {
  int value = 0;
  row.Read(key, &value, meaning);
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
            {"rotor2", CanopenRole::kRotor2}},
           "what the node drives or measures");
  row.Read("node_id", &out->node_id, "its number on the bus");
  ReadUnsigned(row, "vendor", &out->vendor, "object 1018:1 of the node");
  ReadUnsigned(row, "product", &out->product, "object 1018:2");
  ReadUnsigned(row, "serial", &out->serial, "object 1018:4; 0: any");
  if (!IsDrive(out->role)) return;
  row.Read(
      "torque_per_mille_nm", &out->torque_per_mille_nm,
      {"of a drive: torque at the gearbox output for 0.1 % of the motor's rated torque", "N m"});
  row.Read("sign", &out->sign,
           "of a drive: 1 if a positive torque turns the joint counter-clockwise, else -1");
  row.Read("torque_range_nm", &out->torque_range_nm,
           "of a drive: largest torque at the gearbox output; it is written to object 6072");
  row.Read("gear", &out->gear, {"of a drive: turns of the motor for one of the joint", "1"});
  row.Read("position_is_rotor", &out->position_is_rotor,
           "of a drive: true if its position, 6064, is the counter of the joint's rotor");
}

}  // namespace

void ReadCanopen(TableReader row, double period_ms, CanopenConfig* out) {
  out->period_ms = period_ms;
  row.Read("interface", &out->interface, "the CAN interface of the system");
  row.Read("bitrate_bps", &out->bitrate_bps, "bit rate that the interface must have");
  row.Read("master_node_id", &out->master_node_id, "number of the daemon on the bus");
  row.Read("answer_timeout_ms", &out->answer_timeout_ms, "from SYNC until every node has answered");
  row.Read("sdo_timeout_ms", &out->sdo_timeout_ms,
           "longest time for the answer to one SDO, at the start");
  row.Read("boot_timeout_ms", &out->boot_timeout_ms,
           "longest time from a node's reset to its boot-up message");
  row.Read("node_heartbeat_ms", &out->node_heartbeat_ms, "heartbeat period of the nodes");
  row.Read("node_timeout_ms", &out->node_timeout_ms,
           "a node without heartbeat for so long is lost");
  row.Read("master_timeout_ms", &out->master_timeout_ms,
           "a drive without the daemon's heartbeat for so long removes its torque");
  for (const TableReader& node : row.Rows("node", "a drive or an encoder"))
    ReadNode(node, &out->node.emplace_back());
}

}  // namespace flexarm
