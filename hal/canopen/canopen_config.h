#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "model/problem.h"

namespace flexarm {

/// Role of a node. Drives first, then the encoders in the order of the frame's counters.
enum class CanopenRole : std::uint8_t { kDrive1, kDrive2, kHub1, kHub2, kRotor1, kRotor2 };

inline constexpr int kMaxCanopenNodes = 8;

/// "drive1", "drive2", "hub1", "hub2", "rotor1", "rotor2": values of the key `role`.
const char* ToString(CanopenRole role) noexcept;

constexpr bool IsDrive(CanopenRole role) noexcept { return role <= CanopenRole::kDrive2; }

/// One node: [[hal.canopen.node]].
struct CanopenNodeConfig {
  CanopenRole role;
  int node_id;            ///< 1..127
  std::uint32_t vendor;   ///< 1018:1, as expected
  std::uint32_t product;  ///< 1018:2
  std::uint32_t serial;   ///< 1018:4, or 0: any

  // Drives only; not set (0, false) for an encoder.
  double torque_per_mille_nm;  ///< torque at the gearbox output per 0.1 % of rated torque, > 0
  int sign;                ///< +1: positive motor torque turns the joint counter-clockwise; or -1
  double torque_range_nm;  ///< largest torque at the gearbox output, both directions; drive's
                           ///< object 6072
  double gear;             ///< turns of the motor per turn of the joint, 1: direct drive
  bool position_is_rotor;  ///< 6064 is the counter of the joint's rotor

  /// Counter of the frame that the node's position provides, or -1.
  int counter() const noexcept;
  /// Rated torque of the motor (6076) that fits torque_per_mille_nm and gear.
  double rated_motor_torque_mnm() const noexcept { return torque_per_mille_nm * 1e6 / gear; }
  /// torque_range_nm in 0.1 % of rated, rounded down.
  int torque_range_per_mille() const noexcept;
};

/// One CAN interface and its nodes: [[hal.canopen]].
struct CanopenConfig {
  std::string interface;     ///< "can0"
  int bitrate_bps;           ///< bit rate of the interface; a virtual one has none
  double period_ms;          ///< of the exchanges, and of the master's heartbeat
  int master_node_id;        ///< node id of the daemon
  double answer_timeout_ms;  ///< from the start of an exchange until every node has answered SYNC
  int sdo_timeout_ms;        ///< a node's answer to one SDO
  int boot_timeout_ms;       ///< from a node's reset to its boot-up message
  int node_heartbeat_ms;     ///< heartbeat period of the nodes
  int node_timeout_ms;       ///< a node without heartbeat for so long is lost
  int master_timeout_ms;     ///< without the master's heartbeat for so long, a drive removes its
                             ///< torque
  std::vector<CanopenNodeConfig> node;

  /// Longest time on the wire of all frames of one exchange, and of frames that may interleave: a
  /// heartbeat and an emergency of every node, and one frame that had already begun.
  std::int64_t wire_time_ns() const noexcept;
  /// The part of one node in that time.
  std::int64_t wire_time_ns(const CanopenNodeConfig& n) const noexcept;
  /// Bus load, 0..1, with every frame at its longest.
  double bus_load() const noexcept;
  /// Bound of CanopenDevice::Exchange.
  std::int64_t worst_case_exchange_ns() const noexcept;

  /// Violated rules. `section` is the prefix of every key, e.g. "hal.canopen[0].".
  std::vector<Problem> Problems(const std::string& section) const;
};

}  // namespace flexarm
