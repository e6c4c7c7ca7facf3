#include "hal/comedi/comedi_wiring.h"

#include "hal/comedi/comedi_device.h"
#include "hal/comedi/comedi_plan.h"
#include "hal/comedi/libcomedi_board.h"
#include "model/problem_list.h"

namespace flexarm {
namespace {

void CheckDrives(const ComediOutputConfig& out, const std::array<double, 2>& torque_limit_nm,
                 ProblemList* list) {
  for (std::size_t i = 0; i < out.drive.size(); ++i) {
    const ComediDriveConfig& drive = out.drive[i];
    if (drive.joint != 0 && drive.joint != 1) continue;
    const double limit = torque_limit_nm[static_cast<std::size_t>(drive.joint)];
    list->Require(drive.torque_range_nm >= limit,
                  "output." + ProblemList::Element("drive", i) + ".torque_range_nm",
                  NumberText(drive.torque_range_nm),
                  "must cover limits.torque_limit_nm = " + NumberText(limit) + ", which takes " +
                      NumberText(limit / drive.torque_per_volt_nm()) + " V of +-" +
                      NumberText(out.range_v) +
                      " V: the loop may command more than the drive can give");
  }
}

// Counts of the board are counts of the rig: the same converter range and width.
void CheckCounts(const ComediBoardConfig& board, const SensorConfig& sensors, ProblemList* list) {
  if (board.input) {
    const StrainInputConfig& input = sensors.strain_input;
    list->Require(
        board.input->bits == input.converter_bits, "input.bits", NumberText(board.input->bits),
        "must be sensors.strain_input.converter_bits = " + NumberText(input.converter_bits));
    list->Require(board.input->range_v == input.range_v, "input.range_v",
                  NumberText(board.input->range_v),
                  "must be sensors.strain_input.range_v = " + NumberText(input.range_v));
  }
  for (std::size_t i = 0; i < board.counter.size(); ++i) {
    for (const EncoderConfig& encoder : sensors.encoder) {
      if (encoder.counter != board.counter[i].counter) continue;
      list->Require(board.counter[i].bits == encoder.counter_bits,
                    ProblemList::Element("counter", i) + ".bits", NumberText(board.counter[i].bits),
                    "must be the counter_bits of its [[sensors.encoder]], " +
                        NumberText(encoder.counter_bits));
    }
  }
}

// Subdevices of the channels, in the order of the plan.
std::vector<int> Subdevices(const ComediBoardConfig& config) {
  std::vector<int> all;
  if (config.output) all.insert(all.end(), config.output->drive.size(), config.output->subdevice);
  if (config.input) all.insert(all.end(), config.input->channel.size(), config.input->subdevice);
  for (const ComediCounterConfig& row : config.counter) all.push_back(row.subdevice);
  for (const ComediLineConfig& row : config.line) all.push_back(row.subdevice);
  return all;
}

}  // namespace

std::vector<Problem> ComediWiring::Problems(const std::string& section,
                                            const BusRequirements& required) const {
  ProblemList list(section);
  CheckCounts(config_, required.sensors, &list);
  if (config_.output) CheckDrives(*config_.output, required.torque_limit_nm, &list);
  std::vector<Problem> all =
      config_.Problems(section, required.sensors.strain.size(), required.available_ns);
  for (Problem& problem : list.Take()) all.push_back(std::move(problem));
  return all;
}

std::vector<WiredItem> ComediWiring::Items() const {
  std::vector<WiredItem> items;
  for (std::size_t i = 0; config_.input && i < config_.input->channel.size(); ++i) {
    items.push_back({WiredItem::Kind::kStrain, config_.input->channel[i].strain,
                     "input." + ProblemList::Element("channel", i)});
  }
  for (std::size_t i = 0; config_.output && i < config_.output->drive.size(); ++i) {
    items.push_back({WiredItem::Kind::kDrive, config_.output->drive[i].joint,
                     "output." + ProblemList::Element("drive", i)});
  }
  for (std::size_t i = 0; i < config_.counter.size(); ++i) {
    items.push_back({WiredItem::Kind::kCounter, config_.counter[i].counter,
                     ProblemList::Element("counter", i)});
  }
  for (std::size_t i = 0; i < config_.line.size(); ++i) {
    items.push_back({WiredItem::Kind::kLine, static_cast<int>(config_.line[i].line),
                     ProblemList::Element("line", i)});
  }
  return items;
}

std::vector<ExclusiveUse> ComediWiring::Exclusive() const {
  return {{"device", config_.device, config_.device, "must be used for one board only"}};
}

BusCost ComediWiring::Cost() const {
  const ComediPlan plan = PlanComedi(config_);
  const std::vector<int> subdevices = Subdevices(config_);
  BusCost bus{.kind = kind(),
              .name = config_.device,
              .channel = {},
              .worst_ns = plan.exchange_worst_ns,
              .oldest_ns = plan.oldest_ns};
  for (std::size_t i = 0; i < plan.channels.size(); ++i) {
    const ComediChannelCost& cost = plan.channels[i];
    bus.channel.push_back({.device = "subdevice " + std::to_string(subdevices[i]),
                           .channel = cost.channel,
                           .transaction = cost.transaction,
                           .cost_ns = cost.exchange_ns,
                           .convert_ns = cost.convert_ns});
  }
  return bus;
}

std::vector<DriveFigures> ComediWiring::Drives() const {
  std::vector<DriveFigures> drives;
  if (!config_.output) return drives;
  for (const ComediDriveConfig& drive : config_.output->drive) {
    drives.push_back({.joint = drive.joint,
                      .bus = config_.device,
                      .unit = "V",
                      .torque_per_unit_nm = drive.torque_per_volt_nm(),
                      .gear = drive.gear,
                      .sign = drive.sign,
                      .range_nm = drive.torque_range_nm,
                      .unit_range = config_.output->range_v});
  }
  return drives;
}

std::unique_ptr<BusDevice> ComediWiring::MakeDevice(const BusClocks& clocks) const {
  return std::make_unique<ComediDevice>(
      config_, std::make_unique<LibcomediBoard>(config_.device, clocks.monotonic_ns));
}

}  // namespace flexarm
