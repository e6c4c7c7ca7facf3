#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "hal/canopen/can_bus.h"
#include "hal/canopen/socketcan_bus.h"
#include "hal/emulation/gpio_sim.h"
#include "hal/emulation/simulated_amplifier.h"
#include "hal/emulation/simulated_node.h"
#include "hal/sim/sim_config.h"
#include "hal/sim/simulated_rig.h"
#include "hal/wired/hal_config.h"

namespace flexarm {

/// The simulated arm behind the real protocols, wired as in the daemon's config: CANopen drives and
/// encoders, Modbus strain amplifiers, switches, relay and charge pump on gpio-sim lines. The
/// unchanged daemon with its hardware drivers runs against it.
///
/// Tests check the state of its hardware: a drive makes torque only while its own state machine is
/// in operation, the relay is closed, and the charge pump has toggled within 5 ms.
/// Thread: one, besides the threads of the Modbus servers, which it starts.
class EmulatedRig {
 public:
  struct Observed {                   ///< state of the hardware, counts since the start
    std::array<double, 2> torque_nm;  ///< now
    bool relay_closed;                ///< now
    bool pump_alive;                  ///< now
    std::int64_t powered_slices;      ///< milliseconds in which a drive made torque
    std::int64_t active_slices;       ///< or would have made torque with power on
  };

  /// @param arm  with the actual payload of the plant
  /// @param supply  of the CANopen drives, fed through the relay; none: they are always supplied
  /// @throws HalError
  EmulatedRig(const ArmParameters& arm, const SensorConfig& sensors, const SimConfig& sim,
              const HalConfig& hal, const BusClocks& clocks,
              const std::optional<DriveSupplyModel>& supply = std::nullopt);

  /// Simulates one millisecond, up to `now_ns` of CLOCK_MONOTONIC.
  void Step(std::int64_t now_ns) noexcept;

  /// Forces a switch or the button, as SimulatedRig::Press.
  void Press(Line line, int level) noexcept { rig_.Press(line, level); }

  // Devices with fault injection: null if the rig has none with that name.
  SimulatedNode* FindNode(std::string_view role) noexcept;  ///< "drive1" .. "rotor2"
  SimulatedAmplifier* FindAmplifier(std::string_view name) noexcept;

  const Observed& observed() const noexcept { return observed_; }

 private:
  struct Node {
    CanopenNodeConfig config;
    std::unique_ptr<CanBus> bus;
    std::unique_ptr<SimulatedNode> node;
  };

  void AddNodes(const CanopenConfig& bus, const BusClocks& clocks,
                const std::optional<DriveSupplyModel>& supply);
  bool PowerOn(std::int64_t now_ns) noexcept;
  void DriveArm(bool power) noexcept;
  void Show(std::int64_t now_ns) noexcept;

  SimulatedRig rig_;
  GpiodConfig lines_;
  GpioSim gpio_;
  std::vector<Node> nodes_;
  std::vector<std::unique_ptr<SimulatedAmplifier>> amplifiers_;
  std::size_t refreshed_ = 0;  // input written again in the last step
  bool pump_level_ = false;
  std::int64_t pump_toggled_ns_ = INT64_MIN;
  Observed observed_{};
};

}  // namespace flexarm
