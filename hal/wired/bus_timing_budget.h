#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hal/wired/hal_config.h"

namespace flexarm {

/// What one channel costs of an exchange with its bus.
struct ChannelCost {
  std::string device;       ///< on the bus: "node 11", "unit 1", "subdevice 0"
  std::string channel;      ///< "strain[3]", "drive1", "hub2", a line's name
  int transaction;          ///< channels with the same one share its time
  std::int64_t cost_ns;     ///< of the whole transaction, at worst
  std::int64_t convert_ns;  ///< of the board's own scan, beforehand; 0: none
};

/// What one bus costs. Every bus has a thread of its own, so each has all the time that there is.
struct BusCost {
  std::string kind;                  ///< "canopen", "modbus", "comedi"
  std::string name;                  ///< as the daemon's thread is called
  std::vector<ChannelCost> channel;  ///< in the order of the exchange
  std::int64_t other_ns;             ///< waiting, waking and computing: no channel's
  std::int64_t worst_ns;             ///< bound of an exchange: every transaction once, and other_ns
  std::int64_t oldest_ns;            ///< age that a streamed reading can have; 0: none is streamed
};

/// In the order in which the rig opens its buses. `hal` without problems.
std::vector<BusCost> AcquisitionCosts(const HalConfig& hal);

/// How a torque becomes what a drive understands.
struct DriveFigures {
  int joint;                  ///< 0 or 1
  std::string bus;            ///< BusCost::name
  const char* unit;           ///< "V", or "per mille" of the drive's rated torque
  double torque_per_unit_nm;  ///< at the gearbox output
  double gear;                ///< turns of the motor per turn of the joint
  int sign;                   ///< of the unit, when the torque is counter-clockwise
  double range_nm;            ///< at the gearbox output, either way
  double unit_range;          ///< most that the drive takes, in its unit
};

/// Every drive of the rig, joint 1 first. `hal` without problems.
std::vector<DriveFigures> FiguresOfDrives(const HalConfig& hal);

}  // namespace flexarm
