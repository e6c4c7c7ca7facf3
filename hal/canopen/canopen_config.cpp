#include "hal/canopen/canopen_config.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "hal/canopen/can_frame.h"
#include "hal/canopen/canopen_codec.h"
#include "model/problem_list.h"

namespace flexarm {
namespace {

constexpr int kCommandBytes = 4, kFeedbackBytes = 8, kEncoderBytes = 4, kEmergencyBytes = 8;

// Answer time of the nodes, besides the bus: drives sample and send within half a millisecond.
constexpr double kNodeAnswer_ms = 0.5;
// Computing, emptying the queue, waking up late at FIFO 70.
constexpr std::int64_t kMargin_ns = 1'000'000;
constexpr double kMostLoad = 0.6;

int FeedbackBytes(const CanopenNodeConfig& node) {
  return IsDrive(node.role) ? kFeedbackBytes : kEncoderBytes;
}

void CheckDrive(const CanopenNodeConfig& node, const std::string& row, ProblemList* list) {
  list->Positive(row + ".torque_per_mille_nm", node.torque_per_mille_nm, 100.0,
                 "torque at the gearbox output per 0.1 % of rated torque");
  list->Require(node.sign == 1 || node.sign == -1, row + ".sign", NumberText(node.sign),
                "must be 1, or -1 if positive torque turns the joint clockwise");
  list->Within(row + ".gear", node.gear, 1.0, 1000.0, "turns of the motor per turn of the joint");
  const double range_per_mille = node.torque_range_nm / node.torque_per_mille_nm;
  list->Require(range_per_mille >= 1.0 && range_per_mille <= 5000.0, row + ".torque_range_nm",
                NumberText(node.torque_range_nm),
                "must be 1 to 5000 times torque_per_mille_nm: no drive has more than five times "
                "its rated torque");
  list->Require(node.rated_motor_torque_mnm() >= 1.0 && node.rated_motor_torque_mnm() <= 1e9,
                row + ".torque_per_mille_nm", NumberText(node.torque_per_mille_nm),
                "must give a rated motor torque of 1 mN m to 1 MN m: 1000 times it, over gear");
}

void CheckEncoder(const CanopenNodeConfig& node, const std::string& row, ProblemList* list) {
  list->Require(node.torque_per_mille_nm == 0.0 && node.sign == 0 && node.torque_range_nm == 0.0 &&
                    node.gear == 0.0 && !node.position_is_rotor,
                row + ".role", ToString(node.role),
                "must have no torque_per_mille_nm, sign, torque_range_nm, gear or "
                "position_is_rotor: only drives have them");
}

void CheckNodes(const CanopenConfig& config, ProblemList* list) {
  list->Require(!config.node.empty() && config.node.size() <= std::size_t{kMaxCanopenNodes}, "node",
                NumberText(config.node.size()) + " rows",
                "must have 1 to " + NumberText(kMaxCanopenNodes) + " rows");
  for (std::size_t i = 0; i < config.node.size(); ++i) {
    const CanopenNodeConfig& node = config.node[i];
    const std::string row = ProblemList::Element("node", i);
    list->Within(row + ".node_id", node.node_id, 1, kMaxNodeId, "CiA 301 has node ids 1 to 127");
    list->Require(node.node_id != config.master_node_id, row + ".node_id", NumberText(node.node_id),
                  "must differ from master_node_id");
    list->Require(node.vendor != 0, row + ".vendor", "0",
                  "must be the vendor id that the node has in 1018:1");
    for (std::size_t k = 0; k < i; ++k) {
      const CanopenNodeConfig& other = config.node[k];
      list->Require(node.node_id != other.node_id, row + ".node_id", NumberText(node.node_id),
                    "must be used once: " + ProblemList::Element("node", k) + " uses it too");
      list->Require(node.role != other.role, row + ".role", ToString(node.role),
                    "must be used once: " + ProblemList::Element("node", k) + " uses it too");
      list->Require(
          node.role == other.role || node.counter() < 0 || node.counter() != other.counter(),
          row + ".position_is_rotor", ToString(node.role),
          "must be left to " + ProblemList::Element("node", k) +
              ", which already reads this counter");
    }
    IsDrive(node.role) ? CheckDrive(node, row, list) : CheckEncoder(node, row, list);
  }
}

void CheckTimes(const CanopenConfig& config, ProblemList* list) {
  const double wire_ms = static_cast<double>(config.wire_time_ns()) * 1e-6;
  list->Within("answer_timeout_ms", config.answer_timeout_ms, wire_ms + kNodeAnswer_ms,
               config.period_ms / 2.0,
               "the frames of one exchange take " + NumberText(wire_ms) +
                   " ms at worst, the nodes half a millisecond; the other half of the period is "
                   "reserved for the rest of the loop");
  list->Within("node_timeout_ms", config.node_timeout_ms, 2 * config.node_heartbeat_ms, 2000,
               "at least two heartbeats, or one lost frame would count as a lost node");
  // A drive's timer keeps running while one heartbeat is late by a whole period.
  const int least = static_cast<int>(std::ceil(2.5 * config.period_ms));
  list->Within("master_timeout_ms", config.master_timeout_ms, least, std::max(least, 200),
               "at least two and a half periods, or one late heartbeat stops the arm; above 200 ms "
               "the torque of a dead daemon would last too long");
}

}  // namespace

const char* ToString(CanopenRole role) noexcept {
  switch (role) {
    case CanopenRole::kDrive1:
      return "drive1";
    case CanopenRole::kDrive2:
      return "drive2";
    case CanopenRole::kHub1:
      return "hub1";
    case CanopenRole::kHub2:
      return "hub2";
    case CanopenRole::kRotor1:
      return "rotor1";
    case CanopenRole::kRotor2:
      return "rotor2";
  }
  return "?";
}

int CanopenNodeConfig::counter() const noexcept {
  if (!IsDrive(role)) return static_cast<int>(role) - static_cast<int>(CanopenRole::kHub1);
  if (!position_is_rotor) return -1;
  return role == CanopenRole::kDrive1 ? 2 : 3;
}

int CanopenNodeConfig::torque_range_per_mille() const noexcept {
  // 1e-9: the rounding of a range that is a whole multiple, such as 30 / 0.03.
  return static_cast<int>(std::floor(torque_range_nm / torque_per_mille_nm * (1.0 + 1e-9)));
}

std::int64_t CanopenConfig::wire_time_ns(const CanopenNodeConfig& n) const noexcept {
  int bits = WorstCaseBits(FeedbackBytes(n)) + WorstCaseBits(1) + WorstCaseBits(kEmergencyBytes);
  if (IsDrive(n.role)) bits += WorstCaseBits(kCommandBytes);
  return std::int64_t{bits} * 1'000'000'000 / std::max(bitrate_bps, 1);
}

std::int64_t CanopenConfig::wire_time_ns() const noexcept {
  // A foreign frame, SYNC, heartbeat.
  const int bits = WorstCaseBits(8) + WorstCaseBits(0) + WorstCaseBits(1);
  std::int64_t time_ns = std::int64_t{bits} * 1'000'000'000 / std::max(bitrate_bps, 1);
  for (const CanopenNodeConfig& n : node) time_ns += wire_time_ns(n);
  return time_ns;
}

double CanopenConfig::bus_load() const noexcept {
  double bits_per_s = 0.0;
  const double exchanges_per_s = 1e3 / period_ms;
  bits_per_s += exchanges_per_s * (WorstCaseBits(0) + WorstCaseBits(1));
  for (const CanopenNodeConfig& n : node) {
    if (IsDrive(n.role)) bits_per_s += exchanges_per_s * WorstCaseBits(kCommandBytes);
    bits_per_s += exchanges_per_s * WorstCaseBits(FeedbackBytes(n));
    bits_per_s += 1e3 / node_heartbeat_ms * WorstCaseBits(1);
  }
  return bits_per_s / bitrate_bps;
}

std::int64_t CanopenConfig::worst_case_exchange_ns() const noexcept {
  return std::llround(answer_timeout_ms * 1e6) + kMargin_ns;
}

std::vector<Problem> CanopenConfig::Problems(const std::string& section) const {
  ProblemList list(section);
  list.Require(!interface.empty() && interface.size() <= 15, "interface", interface,
               "must name a CAN interface, at most 15 characters");
  constexpr std::array kBitrates = {125'000, 250'000, 500'000, 800'000, 1'000'000};
  list.Require(std::find(kBitrates.begin(), kBitrates.end(), bitrate_bps) != kBitrates.end(),
               "bitrate_bps", NumberText(bitrate_bps),
               "must be 125000, 250000, 500000, 800000 or 1000000: the bit rates of CiA 301 that "
               "are fast enough");
  list.Within("period_ms", period_ms, 1.0, 100.0, "period of the loop");
  list.Within("master_node_id", master_node_id, 1, kMaxNodeId, "the daemon's own node id");
  CheckNodes(*this, &list);
  list.Within("sdo_timeout_ms", sdo_timeout_ms, 1, 1000, "time-out of a node's answer to one SDO");
  list.Within("boot_timeout_ms", boot_timeout_ms, 10, 60000,
              "time from a node's reset to its boot-up message");
  list.Within("node_heartbeat_ms", node_heartbeat_ms, 5, 1000,
              "producer heartbeat time of the nodes; 0 would mean none");
  if (!list.empty()) return list.Take();  // times need valid values
  CheckTimes(*this, &list);
  list.Require(bus_load() <= kMostLoad, "bitrate_bps", NumberText(bitrate_bps),
               "must use at most " + NumberText(kMostLoad) +
                   " of the bus's time: " + NumberText(bus_load()) + " are used");
  return list.Take();
}

}  // namespace flexarm
