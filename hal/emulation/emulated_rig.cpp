#include "hal/emulation/emulated_rig.h"

#include "hal/bus_device.h"
#include "hal/canopen/canopen_wiring.h"
#include "hal/modbus/modbus_wiring.h"
#include "hal/safety_lines.h"

namespace flexarm {
namespace {

constexpr std::int64_t kSliceNs = 1'000'000;

const GpiodConfig& LinesOf(const HalConfig& hal) {
  if (!hal.gpiod) throw HalError("no safety chain: section [hal.gpiod] is missing");
  return *hal.gpiod;
}

}  // namespace

EmulatedRig::EmulatedRig(const ArmParameters& arm, const SensorConfig& sensors,
                         const SimConfig& sim, const HalConfig& hal, const BusClocks& clocks,
                         const std::optional<DriveSupplyModel>& supply)
    : rig_(arm, sensors, sim), lines_(LinesOf(hal)), gpio_(lines_.chip) {
  for (const CanopenConfig& bus : ConfigsOf<CanopenWiring>(hal)) AddNodes(bus, clocks, supply);
  for (const ModbusDeviceConfig& device : ConfigsOf<ModbusWiring>(hal)) {
    amplifiers_.push_back(std::make_unique<SimulatedAmplifier>(device, sensors));
  }
}

void EmulatedRig::AddNodes(const CanopenConfig& bus, const BusClocks& clocks,
                           const std::optional<DriveSupplyModel>& supply) {
  for (const CanopenNodeConfig& config : bus.node) {
    Node node{.config = config,
              .bus = std::make_unique<SocketCanBus>(bus.interface, clocks),
              .node = nullptr};
    SimulatedNodeConfig simulated = SimulatedNodeOf(config);
    if (IsDrive(config.role)) simulated.supply = supply;
    node.node = std::make_unique<SimulatedNode>(node.bus.get(), simulated);
    node.node->Start();
    nodes_.push_back(std::move(node));
  }
}

SimulatedNode* EmulatedRig::FindNode(std::string_view role) noexcept {
  for (const Node& node : nodes_) {
    if (role == ToString(node.config.role)) return node.node.get();
  }
  return nullptr;
}

SimulatedAmplifier* EmulatedRig::FindAmplifier(std::string_view name) noexcept {
  for (const auto& amplifier : amplifiers_) {
    if (amplifier->name() == name) return amplifier.get();
  }
  return nullptr;
}

void EmulatedRig::Step(std::int64_t now_ns) noexcept {
  for (Node& node : nodes_) node.node->Run();
  DriveArm(PowerOn(now_ns));
  for (std::int64_t t = 0; t < kSliceNs; t += rig_.step_ns()) rig_.Step();
  Show(now_ns);
}

bool EmulatedRig::PowerOn(std::int64_t now_ns) noexcept {
  const bool pump = gpio_.Value(lines_.pump);
  if (pump != pump_level_) {
    pump_level_ = pump;
    pump_toggled_ns_ = now_ns;
  }
  observed_.relay_closed = gpio_.Value(lines_.relay);
  observed_.pump_alive =
      pump_toggled_ns_ != INT64_MIN && now_ns - pump_toggled_ns_ <= SafetyLines::kPumpTimeoutNs;
  return observed_.relay_closed && observed_.pump_alive;
}

void EmulatedRig::DriveArm(bool power) noexcept {
  std::array<double, 2> torque_nm{};
  bool active = false;
  for (const Node& node : nodes_) {
    if (!IsDrive(node.config.role)) continue;
    node.node->Feed(power);
    active = active || node.node->torque_per_mille() != 0;
    if (!power) continue;
    torque_nm[static_cast<std::size_t>(node.config.role)] =
        node.config.sign * node.node->torque_per_mille() * node.config.torque_per_mille_nm;
  }
  if (active) ++observed_.active_slices;
  rig_.SetTorque(torque_nm);
  observed_.torque_nm = torque_nm;
  if (torque_nm[0] != 0.0 || torque_nm[1] != 0.0) ++observed_.powered_slices;
}

void EmulatedRig::Show(std::int64_t now_ns) noexcept {
  const SensorFrame frame = rig_.Sample(now_ns);
  for (Node& node : nodes_) {
    const int counter = node.config.counter();
    if (counter >= 0) node.node->SetPosition(frame.counter[static_cast<std::size_t>(counter)]);
  }
  for (const auto& amplifier : amplifiers_) amplifier->Show(frame);
  // A contact outweighs the pull-down that the daemon requests, but the simulated chip has one pull
  // for both: one input a step is written again.
  refreshed_ = (refreshed_ + 1) % kLines;
  gpio_.Forget(lines_.input[refreshed_]);
  for (int i = 0; i < kLines; ++i) {
    const bool level = (frame.levels & LineBit(static_cast<Line>(i))) != 0;
    gpio_.Pull(lines_.input[static_cast<std::size_t>(i)], level);
  }
  if (lines_.relay_contact) {
    gpio_.Forget(*lines_.relay_contact);
    gpio_.Pull(*lines_.relay_contact, !observed_.relay_closed);
  }
}

}  // namespace flexarm
