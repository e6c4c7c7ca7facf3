#include "hal/wired/bus_timing_budget.h"

#include <algorithm>
#include <set>

#include "hal/comedi/comedi_plan.h"
#include "hal/modbus/modbus_plan.h"

namespace flexarm {
namespace {

// The rest of the bound that no transaction uses.
void SetOther(BusCost* bus) {
  bus->other_ns = bus->worst_ns;
  std::set<int> counted;
  for (const ChannelCost& channel : bus->channel) {
    if (counted.insert(channel.transaction).second) bus->other_ns -= channel.cost_ns;
  }
}

BusCost CostOf(const CanopenConfig& config) {
  BusCost bus{.kind = "canopen",
              .name = config.interface,
              .channel = {},
              .other_ns = 0,
              .worst_ns = config.worst_case_exchange_ns(),
              .oldest_ns = 0};
  for (const CanopenNodeConfig& node : config.node) {
    bus.channel.push_back({.device = "node " + std::to_string(node.node_id),
                           .channel = CanopenRoleName(node.role),
                           .transaction = static_cast<int>(bus.channel.size()),
                           .cost_ns = config.wire_time_ns(node),
                           .convert_ns = 0});
  }
  SetOther(&bus);
  return bus;
}

BusCost CostOf(const ModbusDeviceConfig& config) {
  BusCost bus{.kind = "modbus",
              .name = config.name,
              .channel = {},
              .other_ns = 0,
              .worst_ns = PlanModbus(config).exchange_worst_ns,
              .oldest_ns = 0};
  for (const ModbusChannelCost& cost : ChannelCosts(config)) {
    bus.channel.push_back({.device = "unit " + std::to_string(config.unit),
                           .channel = cost.channel,
                           .transaction = cost.request,
                           .cost_ns = cost.worst_ns,
                           .convert_ns = 0});
  }
  SetOther(&bus);
  return bus;
}

// Subdevices of the channels, in the order of the plan.
std::vector<int> Subdevices(const ComediBoardConfig& config) {
  std::vector<int> all;
  if (config.output) all.insert(all.end(), config.output->drive.size(), config.output->subdevice);
  if (config.input) all.insert(all.end(), config.input->channel.size(), config.input->subdevice);
  for (const ComediCounterConfig& row : config.counter) all.push_back(row.subdevice);
  for (const ComediLineConfig& row : config.line) all.push_back(row.subdevice);
  return all;
}

BusCost CostOf(const ComediBoardConfig& config) {
  const ComediPlan plan = PlanComedi(config);
  const std::vector<int> subdevices = Subdevices(config);
  BusCost bus{.kind = "comedi",
              .name = config.device,
              .channel = {},
              .other_ns = 0,
              .worst_ns = plan.exchange_worst_ns,
              .oldest_ns = plan.oldest_ns};
  for (std::size_t i = 0; i < plan.channels.size(); ++i) {
    const ComediChannelCost& cost = plan.channels[i];
    bus.channel.push_back({.device = "subdevice " + std::to_string(subdevices[i]),
                           .channel = cost.channel,
                           .transaction = cost.transaction,
                           .cost_ns = cost.exchange_ns,
                           .convert_ns = cost.convert_ns});
  }
  SetOther(&bus);
  return bus;
}

}  // namespace

std::vector<BusCost> AcquisitionCosts(const HalConfig& hal) {
  std::vector<BusCost> costs;
  for (const CanopenConfig& bus : hal.canopen) costs.push_back(CostOf(bus));
  for (const ModbusDeviceConfig& device : hal.modbus.device) costs.push_back(CostOf(device));
  for (const ComediBoardConfig& board : hal.comedi) costs.push_back(CostOf(board));
  return costs;
}

std::vector<DriveFigures> FiguresOfDrives(const HalConfig& hal) {
  std::vector<DriveFigures> drives;
  for (const CanopenConfig& bus : hal.canopen) {
    for (const CanopenNodeConfig& node : bus.node) {
      if (!IsDrive(node.role)) continue;
      drives.push_back({.joint = static_cast<int>(node.role),
                        .bus = bus.interface,
                        .unit = "per mille",
                        .torque_per_unit_nm = node.torque_per_mille_nm,
                        .gear = node.gear,
                        .sign = node.sign,
                        .range_nm = node.torque_range_nm,
                        .unit_range = static_cast<double>(node.torque_range_per_mille())});
    }
  }
  for (const ComediBoardConfig& board : hal.comedi) {
    if (!board.output) continue;
    for (const ComediDriveConfig& drive : board.output->drive) {
      drives.push_back({.joint = drive.joint,
                        .bus = board.device,
                        .unit = "V",
                        .torque_per_unit_nm = drive.torque_per_volt_nm(),
                        .gear = drive.gear,
                        .sign = drive.sign,
                        .range_nm = drive.torque_range_nm,
                        .unit_range = board.output->range_v});
    }
  }
  std::sort(drives.begin(), drives.end(),
            [](const DriveFigures& a, const DriveFigures& b) { return a.joint < b.joint; });
  return drives;
}

}  // namespace flexarm
