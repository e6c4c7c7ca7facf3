#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hal/bus_wiring.h"
#include "hal/gpiod/gpiod_config.h"
#include "hal/sensor_config.h"
#include "model/problem.h"

namespace flexarm {

/// Wiring of a real rig, section [hal]: buses in any combination, and the safety chain. Empty for
/// the simulated backend in the process. It knows no kind of bus: config/hal_binding.cpp has the
/// table of them.
struct HalConfig {
  struct Bus {
    std::string row;  ///< below "hal.": "canopen[0]"
    std::shared_ptr<const BusWiring> wiring;
  };
  std::vector<Bus> bus;              ///< in the order in which the rig opens them
  std::optional<GpiodConfig> gpiod;  ///< [hal.gpiod]

  bool empty() const { return bus.empty() && !gpiod; }

  /// Appends a bus; its row follows the last one of its kind.
  void Add(std::shared_ptr<const BusWiring> wiring);

  /// Violated rules of every part, and of the whole: each sensor of the rig, each drive and the
  /// safety chain must be wired exactly once, over all buses, and every exchange must fit into the
  /// available time.
  std::vector<Problem> Problems(const BusRequirements& required) const;
};

/// The configs of the buses of one kind, in the order of their rows; e.g. Wiring = CanopenWiring.
template <typename Wiring>
std::vector<typename Wiring::Config> ConfigsOf(const HalConfig& hal) {
  std::vector<typename Wiring::Config> all;
  for (const HalConfig::Bus& bus : hal.bus) {
    if (const auto* wiring = dynamic_cast<const Wiring*>(bus.wiring.get())) {
      all.push_back(wiring->config());
    }
  }
  return all;
}

/// Times of every bus, in the order of HalConfig::bus. `hal` without problems.
std::vector<BusCost> AcquisitionCosts(const HalConfig& hal);

/// Every drive of the rig, joint 1 first. `hal` without problems.
std::vector<DriveFigures> FiguresOfDrives(const HalConfig& hal);

}  // namespace flexarm
