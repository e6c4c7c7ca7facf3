#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hal/wired/hal_config.h"

namespace flexarm {

/// Time of one channel in an exchange with its bus.
struct ChannelCost {
  std::string device;       ///< on the bus: "node 11", "unit 1", "subdevice 0"
  std::string channel;      ///< "strain[3]", "drive1", "hub2", a line's name
  int transaction;          ///< channels of the same transaction share its time
  std::int64_t cost_ns;     ///< worst case of the whole transaction
  std::int64_t convert_ns;  ///< time in the board's own scan, before the exchange; 0: none
};

/// Time of one bus. Every bus has its own thread, so each has the whole available time.
struct BusCost {
  std::string kind;                  ///< "canopen", "modbus", "comedi"
  std::string name;                  ///< name of the daemon's thread
  std::vector<ChannelCost> channel;  ///< in the order of the exchange
  std::int64_t other_ns;             ///< waiting, waking and computing: not part of a channel
  std::int64_t worst_ns;             ///< bound of an exchange: every transaction once, and other_ns
  std::int64_t oldest_ns;            ///< largest age of a streamed reading; 0: none is streamed
};

/// In the order in which the rig opens its buses. `hal` without problems.
std::vector<BusCost> AcquisitionCosts(const HalConfig& hal);

/// Scaling of a torque into the unit of a drive.
struct DriveFigures {
  int joint;                  ///< 0 or 1
  std::string bus;            ///< BusCost::name
  const char* unit;           ///< "V", or "per mille" of the drive's rated torque
  double torque_per_unit_nm;  ///< at the gearbox output
  double gear;                ///< turns of the motor per turn of the joint
  int sign;                   ///< sign of the unit for a counter-clockwise torque
  double range_nm;            ///< at the gearbox output, both directions
  double unit_range;          ///< largest command of the drive, in its unit
};

/// Every drive of the rig, joint 1 first. `hal` without problems.
std::vector<DriveFigures> FiguresOfDrives(const HalConfig& hal);

}  // namespace flexarm
