#include "hal/comedi/comedi_config.h"

#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "hal/comedi/comedi_plan.h"
#include "hal/line_names.h"
#include "hal/sensor_config.h"
#include "model/problem_list.h"

namespace flexarm {
namespace {

constexpr int kMostChannels = 256;  // per subdevice; no board has more
constexpr int kMostSubdevices = 64;

std::int64_t Nanoseconds(double us) { return std::llround(us * 1e3); }

std::string Milliseconds(std::int64_t ns) {
  return NumberText(std::round(static_cast<double>(ns) / 1e3) / 1e3) + " ms";
}

void CheckSubdevice(const std::string& row, int subdevice, ProblemList* list) {
  list->Within(row + ".subdevice", subdevice, 0, kMostSubdevices - 1,
               "number of the subdevice, from 0, as comedi_board_info lists them");
}

void CheckChannel(const std::string& row, int channel, int channels, std::set<int>* taken,
                  ProblemList* list) {
  list->Within(row + ".channel", channel, 0, channels - 1,
               "the subdevice has " + NumberText(channels) + " channels, counted from 0");
  list->Require(taken->insert(channel).second, row + ".channel", NumberText(channel),
                "must be used by one row only");
}

void CheckStreaming(const ComediInputConfig& in, double period_ms, ProblemList* list) {
  list->Within("input.scan_interval_us", in.scan_interval_us, 10.0, 1e6, "time from scan to scan");
  list->Within("input.convert_interval_us", in.convert_interval_us, 0.0, 1e5,
               "time from channel to channel; 0 if all are sampled simultaneously");
  list->Within("input.transfer_us", in.transfer_us, 0.0, 1e5,
               "longest time from a scan's end until it can be read");
  const double scan_us = in.convert_interval_us * static_cast<double>(in.channel.size());
  list->Require(
      !(scan_us > in.scan_interval_us), "input.scan_interval_us", NumberText(in.scan_interval_us),
      "must hold a whole scan: " + NumberText(in.channel.size()) + " channels at " +
          NumberText(in.convert_interval_us) + " us each take " + NumberText(scan_us) + " us");
  const double oldest_us = in.scan_interval_us + scan_us + in.transfer_us;
  list->Require(
      !(oldest_us > 500.0 * period_ms), "input.scan_interval_us", NumberText(in.scan_interval_us),
      "must be short compared with the loop: the oldest reading would be " + NumberText(oldest_us) +
          " us old (interval, scan and transfer), half a period "
          "is " +
          NumberText(500.0 * period_ms) + " us");
}

void CheckInput(const ComediBoardConfig& board, std::size_t strain_rows, ProblemList* list) {
  const ComediInputConfig& in = *board.input;
  CheckSubdevice("input", in.subdevice, list);
  list->Within("input.channels", in.channels, 1, kMostChannels, "analogue inputs of the board");
  list->Within("input.bits", in.bits, 8, 24, "of the board's converter");
  list->Within("input.range_v", in.range_v, 0.01, 100.0, "full scale is -range_v .. +range_v");
  list->Require(!in.channel.empty(), "input.channel", "0 rows", "must have at least one row");
  const auto most = static_cast<std::size_t>(in.channels < 0 ? 0 : in.channels);
  list->Require(in.channel.size() <= most, "input.channel", NumberText(in.channel.size()) + " rows",
                "must be at most the board's inputs: it has " + NumberText(in.channels) +
                    "; more gauges need another board, or half bridges");
  std::set<int> taken;
  for (std::size_t i = 0; i < in.channel.size(); ++i) {
    const ComediStrainConfig& row = in.channel[i];
    const std::string key = "input." + ProblemList::Element("channel", i);
    const bool known = row.strain >= 0 && static_cast<std::size_t>(row.strain) < strain_rows;
    list->Require(
        known, key + ".strain", NumberText(row.strain),
        "must be a row of [[sensors.strain]], from 0; it has rows: " + NumberText(strain_rows));
    CheckChannel(key, row.channel, in.channels, &taken, list);
  }
  if (in.acquisition == ComediAcquisition::kStream) CheckStreaming(in, board.period_ms, list);
}

void CheckDrive(const ComediDriveConfig& drive, double range_v, const std::string& row,
                ProblemList* list) {
  list->Within(row + ".role", drive.joint, 0, 1,
               "\"drive1\" or \"drive2\": the arm has two joints");
  list->Positive(row + ".motor_torque_per_volt_nm", drive.motor_torque_per_volt_nm, 1000.0,
                 "amplifier and motor together, before the gear");
  list->Within(row + ".gear", drive.gear, 1.0, 1000.0, "turns of the motor per turn of the joint");
  list->Require(drive.sign == 1 || drive.sign == -1, row + ".sign", NumberText(drive.sign),
                "must be 1, or -1 if positive volts turn the joint clockwise");
  const double most_nm = drive.torque_per_volt_nm() * range_v;
  // 1e-9: the rounding of a range that uses all the volts, such as 10 * 3.
  list->Require(drive.torque_range_nm > 0.0 && drive.torque_range_nm <= most_nm * (1.0 + 1e-9),
                row + ".torque_range_nm", NumberText(drive.torque_range_nm),
                "must be above 0 and within the output's range: " + NumberText(range_v) + " V at " +
                    NumberText(drive.torque_per_volt_nm()) + " N m per volt (" +
                    NumberText(drive.motor_torque_per_volt_nm) + " at the motor, gear " +
                    NumberText(drive.gear) + ") are " + NumberText(most_nm) + " N m");
}

void CheckOutput(const ComediOutputConfig& out, ProblemList* list) {
  CheckSubdevice("output", out.subdevice, list);
  list->Within("output.channels", out.channels, 1, kMostChannels, "analogue outputs of the board");
  list->Within("output.bits", out.bits, 8, 24, "of the board's converter");
  list->Within("output.range_v", out.range_v, 0.01, 100.0, "full scale is -range_v .. +range_v");
  list->Require(!out.drive.empty(), "output.drive", "0 rows", "must have at least one row");
  std::set<int> taken;
  for (std::size_t i = 0; i < out.drive.size(); ++i) {
    const std::string row = "output." + ProblemList::Element("drive", i);
    CheckDrive(out.drive[i], out.range_v, row, list);
    CheckChannel(row, out.drive[i].channel, out.channels, &taken, list);
  }
}

void CheckCountersAndLines(const ComediBoardConfig& board, ProblemList* list) {
  std::set<std::pair<int, int>> taken;
  const auto place = [&](const std::string& row, int subdevice, int channel, int most) {
    CheckSubdevice(row, subdevice, list);
    list->Within(row + ".channel", channel, 0, most, "of the subdevice, counted from 0");
    list->Require(taken.insert({subdevice, channel}).second, row + ".channel", NumberText(channel),
                  "must be used by one row only");
  };
  for (std::size_t i = 0; i < board.counter.size(); ++i) {
    const std::string row = ProblemList::Element("counter", i);
    list->Within(row + ".role", board.counter[i].counter, 0, kCounters - 1,
                 R"("hub1", "hub2", "rotor1" or "rotor2")");
    list->Within(row + ".bits", board.counter[i].bits, 4, 32, "the counter wraps at 2^bits");
    place(row, board.counter[i].subdevice, board.counter[i].channel, kMostChannels - 1);
  }
  for (std::size_t i = 0; i < board.line.size(); ++i) {
    place(ProblemList::Element("line", i), board.line[i].subdevice, board.line[i].channel, 31);
  }
}

// Names the first channel that is too late, and the time it takes.
void CheckTime(const ComediBoardConfig& board, std::int64_t available_ns, ProblemList* list) {
  const ComediPlan plan = PlanComedi(board);
  std::map<int, const ComediChannelCost*> transactions;  // by their first channel
  for (const ComediChannelCost& cost : plan.channels)
    transactions.insert({cost.transaction, &cost});
  std::int64_t ends_ns = plan.exchange_worst_ns;
  for (const auto& [number, cost] : transactions) ends_ns -= cost->exchange_ns;
  std::string first, costs;
  for (const auto& [number, cost] : transactions) {
    ends_ns += cost->exchange_ns;
    costs += "; " + cost->channel + " " + Milliseconds(cost->exchange_ns);
    if (ends_ns <= available_ns || !first.empty()) continue;
    first = cost->channel + " costs " + Milliseconds(cost->exchange_ns) + " and ends at " +
            Milliseconds(ends_ns) + "; ";
  }
  const bool single = board.input && board.input->acquisition == ComediAcquisition::kSingle;
  list->Require(plan.exchange_worst_ns <= available_ns, "instruction_us",
                NumberText(board.instruction_us),
                "must leave an exchange within " + Milliseconds(available_ns) + ": " + first +
                    "all together take " + Milliseconds(plan.exchange_worst_ns) + costs +
                    (single ? "; a board that can stream (acquisition = \"stream\") reads its "
                              "inputs without that time"
                            : ""));
}

}  // namespace

std::int64_t ComediInputConfig::scan_interval_ns() const { return Nanoseconds(scan_interval_us); }
std::int64_t ComediInputConfig::convert_interval_ns() const {
  return Nanoseconds(convert_interval_us);
}
std::int64_t ComediInputConfig::transfer_ns() const { return Nanoseconds(transfer_us); }

std::vector<Problem> ComediBoardConfig::Problems(const std::string& section,
                                                 std::size_t strain_rows,
                                                 std::int64_t available_ns) const {
  ProblemList list(section);
  list.Require(device.starts_with("/dev/"), "device", device,
               "must be a comedi device, e.g. \"/dev/comedi0\"");
  list.Require(!driver.empty(), "driver", driver,
               "must name the kernel's driver, as comedi_board_info prints it");
  list.Require(!board.empty(), "board", board, "must name the board, as comedi_board_info does");
  list.Positive("instruction_us", instruction_us, 1e6,
                "longest single read or write; PCI boards take about 20, USB boards about 2000");
  list.Require(input || output || !counter.empty() || !line.empty(), "device", device,
               "must have an input, output, counter or line: the board would have no function");
  if (input) CheckInput(*this, strain_rows, &list);
  if (output) CheckOutput(*output, &list);
  CheckCountersAndLines(*this, &list);
  if (list.empty()) CheckTime(*this, available_ns, &list);  // times are valid
  return list.Take();
}

std::string ChannelName(const ComediStrainConfig& row) {
  return ProblemList::Element("strain", static_cast<std::size_t>(row.strain));
}

std::string ChannelName(const ComediDriveConfig& row) {
  return "drive" + std::to_string(row.joint + 1);
}

std::string ChannelName(const ComediCounterConfig& row) { return CounterName(row.counter); }

std::string ChannelName(const ComediLineConfig& row) { return ToString(row.line); }

}  // namespace flexarm
