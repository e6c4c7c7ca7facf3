#include "hal/wired/hal_config.h"

#include <array>
#include <set>
#include <string>

#include "hal/line_names.h"
#include "model/problem_list.h"

namespace flexarm {
namespace {

constexpr std::array<const char*, kCounters> kEncoders = {"hub1", "hub2", "rotor1", "rotor2"};

void Append(const std::vector<Problem>& more, std::vector<Problem>* all) {
  all->insert(all->end(), more.begin(), more.end());
}

// Config rows in which something is wired.
using Places = std::vector<std::string>;

// The rows of every counter, drive, strain channel and line.
struct Census {
  std::array<Places, kCounters> counter;
  std::array<Places, 2> drive;
  std::vector<Places> strain;
  std::array<Places, kLines> line;

  void AddStrain(int row, const std::string& place) {
    if (row < 0 || static_cast<std::size_t>(row) >= strain.size())
      return;  // reported by its own rule
    strain[static_cast<std::size_t>(row)].push_back(place);
  }
  template <std::size_t n>
  static void Add(int index, const std::string& place, std::array<Places, n>* all) {
    if (index < 0 || static_cast<std::size_t>(index) >= n) return;
    (*all)[static_cast<std::size_t>(index)].push_back(place);
  }
};

void CountCanopen(const HalConfig& hal, Census* census) {
  for (std::size_t b = 0; b < hal.canopen.size(); ++b) {
    const std::vector<CanopenNodeConfig>& nodes = hal.canopen[b].node;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      const std::string place =
          ProblemList::Element("canopen", b) + "." + ProblemList::Element("node", n);
      if (IsDrive(nodes[n].role)) {
        Census::Add(static_cast<int>(nodes[n].role), place, &census->drive);
      }
      Census::Add(nodes[n].counter(), place, &census->counter);
    }
  }
}

void CountModbus(const HalConfig& hal, Census* census) {
  for (std::size_t d = 0; d < hal.modbus.device.size(); ++d) {
    const std::vector<ModbusRegister>& map = hal.modbus.device[d].map;
    for (std::size_t r = 0; r < map.size(); ++r) {
      const std::string place =
          ProblemList::Element("modbus", d) + "." + ProblemList::Element("register", r);
      if (map[r].role == ModbusRole::kStrain) {
        census->AddStrain(map[r].index, place);
      } else {
        Census::Add(map[r].index, place, &census->line);
      }
    }
  }
}

void CountComedi(const HalConfig& hal, Census* census) {
  for (std::size_t b = 0; b < hal.comedi.size(); ++b) {
    const ComediBoardConfig& board = hal.comedi[b];
    const std::string at = ProblemList::Element("comedi", b) + ".";
    for (std::size_t i = 0; board.input && i < board.input->channel.size(); ++i) {
      census->AddStrain(board.input->channel[i].strain,
                        at + "input." + ProblemList::Element("channel", i));
    }
    for (std::size_t i = 0; board.output && i < board.output->drive.size(); ++i) {
      Census::Add(board.output->drive[i].joint, at + "output." + ProblemList::Element("drive", i),
                  &census->drive);
    }
    for (std::size_t i = 0; i < board.counter.size(); ++i) {
      Census::Add(board.counter[i].counter, at + ProblemList::Element("counter", i),
                  &census->counter);
    }
    for (std::size_t i = 0; i < board.line.size(); ++i) {
      Census::Add(static_cast<int>(board.line[i].line), at + ProblemList::Element("line", i),
                  &census->line);
    }
  }
}

Census Count(const HalConfig& hal, std::size_t strain_rows) {
  Census census;
  census.strain.resize(strain_rows);
  CountCanopen(hal, &census);
  CountModbus(hal, &census);
  CountComedi(hal, &census);
  return census;
}

std::string Times(const Places& places) { return std::to_string(places.size()) + " times"; }

// "; it is in canopen[0].node[1], comedi[0].output.drive[0]"
std::string Where(const Places& places) {
  std::string text;
  for (const std::string& place : places) text += (text.empty() ? "; it is in " : ", ") + place;
  return text;
}

void RequireOnce(const Places& places, const std::string& key, const std::string& what,
                 ProblemList* list) {
  list->Require(places.size() == 1, key, Times(places),
                "must be wired exactly once: " + what + Where(places));
}

void CheckWiring(const HalConfig& hal, const SensorConfig& sensors, ProblemList* list) {
  const Census census = Count(hal, sensors.strain.size());
  for (std::size_t i = 0; i < kCounters; ++i) {
    const bool present = (sensors.counters_present() >> i & 1u) != 0;
    if (!present && census.counter[i].empty()) continue;
    RequireOnce(census.counter[i], std::string("role ") + kEncoders[i],
                present ? "the encoder of [[sensors.encoder]]"
                        : "and there is no such encoder in [[sensors.encoder]]",
                list);
  }
  for (std::size_t i = 0; i < 2; ++i) {
    RequireOnce(census.drive[i], "role drive" + std::to_string(i + 1), "the drive of a joint",
                list);
  }
  for (std::size_t i = 0; i < sensors.strain.size(); ++i) {
    RequireOnce(census.strain[i], ProblemList::Element("strain", i),
                "the channel of [[sensors.strain]]", list);
  }
  for (std::size_t i = 0; i < census.line.size(); ++i) {
    list->Require(census.line[i].size() <= 1, std::string("line ") + Name(static_cast<Line>(i)),
                  Times(census.line[i]),
                  "must be read once at most, besides [hal.gpiod]" + Where(census.line[i]));
  }
  list->Require(hal.gpiod.has_value(), "gpiod", "missing",
                "must be configured: limit switches, emergency stop, relay and charge pump");
}

// "; on the wire: drive1 430 us, hub1 295 us"
std::string NodeCosts(const CanopenConfig& bus) {
  std::string text;
  for (const CanopenNodeConfig& node : bus.node) {
    text += (text.empty() ? "; on the wire: " : ", ") + std::string(CanopenRoleName(node.role)) +
            " " + std::to_string(bus.wire_time_ns(node) / 1000) + " us";
  }
  return text;
}

void CheckCanopenDrives(const HalConfig& hal, std::int64_t available_ns,
                        const std::array<double, 2>& torque_limit_nm, ProblemList* list) {
  for (std::size_t b = 0; b < hal.canopen.size(); ++b) {
    const CanopenConfig& bus = hal.canopen[b];
    const std::string row = ProblemList::Element("canopen", b);
    list->Require(bus.worst_case_exchange_ns() <= available_ns, row + ".answer_timeout_ms",
                  NumberText(bus.answer_timeout_ms),
                  "must leave room: one exchange takes up to " +
                      std::to_string(bus.worst_case_exchange_ns() / 1000) + " us, " +
                      std::to_string(available_ns / 1000) +
                      " us are available (loop.acquire_before_ms)" + NodeCosts(bus));
    for (std::size_t n = 0; n < bus.node.size(); ++n) {
      const CanopenNodeConfig& node = bus.node[n];
      if (!IsDrive(node.role)) continue;
      const double limit = torque_limit_nm[static_cast<std::size_t>(node.role)];
      list->Require(node.torque_range_nm >= limit,
                    row + "." + ProblemList::Element("node", n) + ".torque_range_nm",
                    NumberText(node.torque_range_nm),
                    "must cover limits.torque_limit_nm = " + NumberText(limit) +
                        ": the loop may command more than the drive can give");
    }
  }
}

void CheckComediDrives(const ComediOutputConfig& out, const std::string& row,
                       const std::array<double, 2>& torque_limit_nm, ProblemList* list) {
  for (std::size_t i = 0; i < out.drive.size(); ++i) {
    const ComediDriveConfig& drive = out.drive[i];
    if (drive.joint != 0 && drive.joint != 1) continue;
    const double limit = torque_limit_nm[static_cast<std::size_t>(drive.joint)];
    list->Require(drive.torque_range_nm >= limit,
                  row + ".output." + ProblemList::Element("drive", i) + ".torque_range_nm",
                  NumberText(drive.torque_range_nm),
                  "must cover limits.torque_limit_nm = " + NumberText(limit) + ", which takes " +
                      NumberText(limit / drive.torque_per_volt_nm()) + " V of +-" +
                      NumberText(out.range_v) +
                      " V: the loop may command more than the drive can give");
  }
}

// Counts of the board are counts of the rig: the same converter range and width.
void CheckComediCounts(const ComediBoardConfig& board, const std::string& row,
                       const SensorConfig& sensors, ProblemList* list) {
  if (board.input) {
    const StrainInputConfig& input = sensors.strain_input;
    list->Require(
        board.input->bits == input.converter_bits, row + ".input.bits",
        NumberText(board.input->bits),
        "must be sensors.strain_input.converter_bits = " + NumberText(input.converter_bits));
    list->Require(board.input->range_v == input.range_v, row + ".input.range_v",
                  NumberText(board.input->range_v),
                  "must be sensors.strain_input.range_v = " + NumberText(input.range_v));
  }
  for (std::size_t i = 0; i < board.counter.size(); ++i) {
    for (const EncoderConfig& encoder : sensors.encoder) {
      if (encoder.counter != board.counter[i].counter) continue;
      list->Require(board.counter[i].bits == encoder.counter_bits,
                    row + "." + ProblemList::Element("counter", i) + ".bits",
                    NumberText(board.counter[i].bits),
                    "must be the counter_bits of its [[sensors.encoder]], " +
                        NumberText(encoder.counter_bits));
    }
  }
}

void CheckComedi(const HalConfig& hal, const SensorConfig& sensors,
                 const std::array<double, 2>& torque_limit_nm, ProblemList* list) {
  std::set<std::string> devices;
  for (std::size_t b = 0; b < hal.comedi.size(); ++b) {
    const ComediBoardConfig& board = hal.comedi[b];
    const std::string row = ProblemList::Element("comedi", b);
    list->Require(devices.insert(board.device).second, row + ".device", board.device,
                  "must be used for one board only");
    CheckComediCounts(board, row, sensors, list);
    if (board.output) CheckComediDrives(*board.output, row, torque_limit_nm, list);
  }
}

}  // namespace

std::vector<Problem> HalConfig::Problems(const SensorConfig& sensors, std::int64_t available_ns,
                                         const std::array<double, 2>& torque_limit_nm) const {
  if (empty()) return {};
  std::vector<Problem> all = modbus.Problems(sensors.strain.size(), available_ns);
  for (std::size_t i = 0; i < canopen.size(); ++i) {
    Append(canopen[i].Problems(ProblemList::Element("hal.canopen", i) + "."), &all);
  }
  for (std::size_t i = 0; i < comedi.size(); ++i) {
    Append(comedi[i].Problems(ProblemList::Element("hal.comedi", i) + ".", sensors.strain.size(),
                              available_ns),
           &all);
  }
  if (gpiod) Append(gpiod->Problems(), &all);
  ProblemList list("hal.");
  CheckWiring(*this, sensors, &list);
  CheckCanopenDrives(*this, available_ns, torque_limit_nm, &list);
  CheckComedi(*this, sensors, torque_limit_nm, &list);
  Append(list.Take(), &all);
  return all;
}

}  // namespace flexarm
