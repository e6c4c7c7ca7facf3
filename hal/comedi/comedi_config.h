#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hal/sensor_frame.h"
#include "model/problem.h"

namespace flexarm {

/// Acquisition mode of the analogue inputs.
enum class ComediAcquisition : std::uint8_t {
  kStream,  ///< the board scans continuously by its own clock; the newest complete scan is used
  kSingle,  ///< one instruction per channel: boards without commands, such as cheap USB ones
};

/// Reference of a voltage measurement; comedi's AREF.
enum class ComediReference : std::uint8_t { kGround, kCommon, kDifferential };

/// A strain channel on an analogue input: [[hal.comedi.input.channel]].
struct ComediStrainConfig {
  int strain;   ///< row of [[sensors.strain]], from 0
  int channel;  ///< of the board, from 0
};

/// The analogue inputs of a board: [hal.comedi.input].
struct ComediInputConfig {
  int subdevice;
  int channels;    ///< of the board, used or not
  int bits;        ///< of its converter
  double range_v;  ///< full scale is -range_v .. +range_v
  ComediReference reference;
  ComediAcquisition acquisition;
  double scan_interval_us;     ///< streaming: scan period, as the board's clock produces it
  double convert_interval_us;  ///< streaming: from channel to channel; 0: all at the same time
  double transfer_us;          ///< streaming: longest time from a scan's end until it can be read
  std::vector<ComediStrainConfig> channel;  ///< in the order of the scan

  std::int64_t scan_interval_ns() const;
  std::int64_t convert_interval_ns() const;
  std::int64_t transfer_ns() const;
};

/// An amplifier with a voltage command input: [[hal.comedi.output.drive]].
struct ComediDriveConfig {
  int joint;                        ///< 0 or 1: key `role` = "drive1" "drive2"
  int channel;                      ///< of the board, from 0
  double motor_torque_per_volt_nm;  ///< amplifier and motor together, before the gear, > 0
  double gear;                      ///< turns of the motor per turn of the joint, 1: direct drive
  int sign;                         ///< +1: positive volts turn the joint counter-clockwise; or -1
  double torque_range_nm;           ///< largest torque at the gearbox output, both directions

  /// At the gearbox output, > 0.
  double torque_per_volt_nm() const noexcept { return motor_torque_per_volt_nm * gear; }
};

/// The analogue outputs of a board: [hal.comedi.output].
struct ComediOutputConfig {
  int subdevice;
  int channels;
  int bits;
  double range_v;
  std::vector<ComediDriveConfig> drive;
};

/// An encoder on a counter of the board: [[hal.comedi.counter]]. The driver only reads it: a
/// counter that has no fixed quadrature mode has to be configured with comedi's tools before.
struct ComediCounterConfig {
  int counter;  ///< of the frame, 0..3: key `role` = "hub1" "hub2" "rotor1" "rotor2"
  int subdevice;
  int channel;
  int bits;  ///< wraps at 2^bits
};

/// A digital input: [[hal.comedi.line]]. A redundant reading of a line of the safety chain, once
/// per period: see MergeRedundantLevels.
struct ComediLineConfig {
  Line line;
  int subdevice;
  int channel;
};

/// One DAQ board: [[hal.comedi]].
struct ComediBoardConfig {
  std::string device;  ///< "/dev/comedi0"
  std::string driver;  ///< as `comedi_board_info` prints them: identifies the board
  std::string board;
  double instruction_us;  ///< longest single read or write; PCI about 20, USB about 2000
  double period_ms;       ///< of the exchanges
  std::optional<ComediInputConfig> input;
  std::optional<ComediOutputConfig> output;
  std::vector<ComediCounterConfig> counter;
  std::vector<ComediLineConfig> line;

  /// Violated rules. `section` is the prefix of every key, e.g. "hal.comedi[0].".
  /// @param strain_rows   rows of [[sensors.strain]]
  /// @param available_ns  time available for one exchange
  std::vector<Problem> Problems(const std::string& section, std::size_t strain_rows,
                                std::int64_t available_ns) const;
};

/// "strain[3]", "drive1", "hub2", or the name of the line: name of a channel in messages and lists.
std::string ChannelName(const ComediStrainConfig& row);
std::string ChannelName(const ComediDriveConfig& row);
std::string ChannelName(const ComediCounterConfig& row);
std::string ChannelName(const ComediLineConfig& row);

}  // namespace flexarm
