#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "hal/bus_clocks.h"
#include "hal/bus_device.h"
#include "hal/sensor_config.h"
#include "model/problem.h"

namespace flexarm {

/// What the rest of the rig requires of each bus.
struct BusRequirements {
  const SensorConfig& sensors;            ///< the channels and counters that the buses read
  std::int64_t available_ns;              ///< from the sampling instant until the step is due
  std::array<double, 2> torque_limit_nm;  ///< largest torque of the loop
};

/// A sensor, drive or digital input that a bus serves, and the config row that says so.
struct WiredItem {
  enum class Kind : std::uint8_t { kCounter, kDrive, kStrain, kLine };
  Kind kind;
  int index;          ///< counter 0..3, joint 0..1, row of [[sensors.strain]], or Line
  std::string place;  ///< below the row of the bus: "node[1]"
};

/// A device, address or name that one bus of the rig must have alone.
struct ExclusiveUse {
  std::string key;       ///< below the row of the bus: "device"
  std::string value;     ///< of that key
  std::string resource;  ///< two buses of a kind with the same text are refused
  std::string rule;      ///< for the message
};

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
  std::string kind;                  ///< BusWiring::kind
  std::string name;                  ///< name of the daemon's thread
  std::vector<ChannelCost> channel;  ///< in the order of the exchange
  std::int64_t worst_ns;             ///< bound of an exchange
  std::int64_t oldest_ns;            ///< largest age of a streamed reading; 0: none is streamed

  /// Waiting, waking and computing: the part of worst_ns that belongs to no transaction.
  std::int64_t other_ns() const;
};

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

/// One bus or board of a rig as its config describes it; each kind of bus has one such class.
///
/// Immutable. Allocates: start-up only. Items, Cost, Drives and MakeDevice need a config without
/// problems, except that Items and Exclusive serve a broken one too.
class BusWiring {
 public:
  virtual ~BusWiring() = default;

  /// The key of its rows: "canopen" for [[hal.canopen]].
  virtual const char* kind() const noexcept = 0;

  /// Violated rules. `section` is the prefix of every key, e.g. "hal.canopen[0].".
  virtual std::vector<Problem> Problems(const std::string& section,
                                        const BusRequirements& required) const = 0;
  virtual std::vector<WiredItem> Items() const = 0;
  virtual std::vector<ExclusiveUse> Exclusive() const { return {}; }
  virtual BusCost Cost() const = 0;
  virtual std::vector<DriveFigures> Drives() const { return {}; }
  /// Whether its drives report their voltage (BusDevice::voltage).
  virtual bool reports_voltage() const noexcept { return false; }

  /// The driver, not opened.
  virtual std::unique_ptr<BusDevice> MakeDevice(const BusClocks& clocks) const = 0;
};

}  // namespace flexarm
