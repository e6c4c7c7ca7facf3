#include "hal/canopen/canopen_wiring.h"

#include "hal/canopen/canopen_device.h"
#include "hal/canopen/socketcan_bus.h"
#include "model/problem_list.h"

namespace flexarm {
namespace {

// "; on the wire: drive1 430 us, hub1 295 us"
std::string NodeCosts(const CanopenConfig& bus) {
  std::string text;
  for (const CanopenNodeConfig& node : bus.node) {
    text += (text.empty() ? "; on the wire: " : ", ") + std::string(ToString(node.role)) + " " +
            std::to_string(bus.wire_time_ns(node) / 1000) + " us";
  }
  return text;
}

}  // namespace

std::vector<Problem> CanopenWiring::Problems(const std::string& section,
                                             const BusRequirements& required) const {
  ProblemList list(section);
  list.Require(config_.worst_case_exchange_ns() <= required.available_ns, "answer_timeout_ms",
               NumberText(config_.answer_timeout_ms),
               "must leave room: one exchange takes up to " +
                   std::to_string(config_.worst_case_exchange_ns() / 1000) + " us, " +
                   std::to_string(required.available_ns / 1000) +
                   " us are available (loop.acquire_before_ms)" + NodeCosts(config_));
  for (std::size_t i = 0; i < config_.node.size(); ++i) {
    const CanopenNodeConfig& node = config_.node[i];
    if (!IsDrive(node.role)) continue;
    const double limit = required.torque_limit_nm[static_cast<std::size_t>(node.role)];
    list.Require(node.torque_range_nm >= limit,
                 ProblemList::Element("node", i) + ".torque_range_nm",
                 NumberText(node.torque_range_nm),
                 "must cover limits.torque_limit_nm = " + NumberText(limit) +
                     ": the loop may command more than the drive can give");
  }
  std::vector<Problem> all = config_.Problems(section);
  for (Problem& problem : list.Take()) all.push_back(std::move(problem));
  return all;
}

std::vector<WiredItem> CanopenWiring::Items() const {
  std::vector<WiredItem> items;
  for (std::size_t i = 0; i < config_.node.size(); ++i) {
    const CanopenNodeConfig& node = config_.node[i];
    const std::string place = ProblemList::Element("node", i);
    if (IsDrive(node.role)) {
      items.push_back({WiredItem::Kind::kDrive, static_cast<int>(node.role), place});
    }
    if (node.counter() >= 0) items.push_back({WiredItem::Kind::kCounter, node.counter(), place});
  }
  return items;
}

BusCost CanopenWiring::Cost() const {
  BusCost bus{.kind = kind(),
              .name = config_.interface,
              .channel = {},
              .worst_ns = config_.worst_case_exchange_ns(),
              .oldest_ns = 0};
  for (const CanopenNodeConfig& node : config_.node) {
    bus.channel.push_back({.device = "node " + std::to_string(node.node_id),
                           .channel = ToString(node.role),
                           .transaction = static_cast<int>(bus.channel.size()),
                           .cost_ns = config_.wire_time_ns(node),
                           .convert_ns = 0});
  }
  return bus;
}

std::vector<DriveFigures> CanopenWiring::Drives() const {
  std::vector<DriveFigures> drives;
  for (const CanopenNodeConfig& node : config_.node) {
    if (!IsDrive(node.role)) continue;
    drives.push_back({.joint = static_cast<int>(node.role),
                      .bus = config_.interface,
                      .unit = "per mille",
                      .torque_per_unit_nm = node.torque_per_mille_nm,
                      .gear = node.gear,
                      .sign = node.sign,
                      .range_nm = node.torque_range_nm,
                      .unit_range = static_cast<double>(node.torque_range_per_mille())});
  }
  return drives;
}

std::unique_ptr<BusDevice> CanopenWiring::MakeDevice(const BusClocks& clocks) const {
  return std::make_unique<CanopenDevice>(config_,
                                         std::make_unique<SocketCanBus>(config_.interface, clocks));
}

}  // namespace flexarm
