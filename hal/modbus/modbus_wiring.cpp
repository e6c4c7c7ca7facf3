#include "hal/modbus/modbus_wiring.h"

#include "hal/modbus/modbus_device.h"
#include "hal/modbus/modbus_plan.h"
#include "model/problem_list.h"

namespace flexarm {

std::vector<Problem> ModbusWiring::Problems(const std::string& section,
                                            const BusRequirements& required) const {
  return config_.Problems(section, required.sensors.strain.size(), required.available_ns);
}

std::vector<WiredItem> ModbusWiring::Items() const {
  std::vector<WiredItem> items;
  for (std::size_t i = 0; i < config_.map.size(); ++i) {
    const ModbusRegister& row = config_.map[i];
    items.push_back(
        {row.role == ModbusRole::kStrain ? WiredItem::Kind::kStrain : WiredItem::Kind::kLine,
         row.index, ProblemList::Element("register", i)});
  }
  return items;
}

std::vector<ExclusiveUse> ModbusWiring::Exclusive() const {
  ExclusiveUse name{"name", config_.name, config_.name, "must be used for one device only"};
  if (config_.transport == ModbusTransport::kTcp) {
    return {std::move(name),
            {"host", config_.host,
             config_.host + " " + std::to_string(config_.port) + " " + std::to_string(config_.unit),
             "must be used once with this port and unit"}};
  }
  return {std::move(name),
          {"device", config_.device, config_.device,
           "must be used for one device only: two masters on a line disturb each other"}};
}

BusCost ModbusWiring::Cost() const {
  BusCost bus{.kind = kind(),
              .name = config_.name,
              .channel = {},
              .worst_ns = PlanModbus(config_).exchange_worst_ns,
              .oldest_ns = 0};
  for (const ModbusChannelCost& cost : ChannelCosts(config_)) {
    bus.channel.push_back({.device = "unit " + std::to_string(config_.unit),
                           .channel = cost.channel,
                           .transaction = cost.request,
                           .cost_ns = cost.worst_ns,
                           .convert_ns = 0});
  }
  return bus;
}

std::unique_ptr<BusDevice> ModbusWiring::MakeDevice(const BusClocks& clocks) const {
  return std::make_unique<ModbusDevice>(config_, clocks.monotonic_ns);
}

}  // namespace flexarm
