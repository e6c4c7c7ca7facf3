#include "config/hal_sections.h"
#include "config/line_key.h"

namespace flexarm {
namespace {

// The role of a drive or of an encoder, with the same names as on the other buses.
void ReadJoint(TableReader row, int* out) {
  row.Read("role", out, {{"drive1", 0}, {"drive2", 1}}, "the joint that it drives");
}
void ReadCounter(TableReader row, int* out) {
  row.Read("role", out, {{"hub1", 0}, {"hub2", 1}, {"rotor1", 2}, {"rotor2", 3}},
           "the angle that it counts");
}

void ReadComediInput(TableReader input, ComediInputConfig* out) {
  input.Read("subdevice", &out->subdevice, "number of the subdevice on the board");
  input.Read("channels", &out->channels, {"channels of the subdevice, used or not", "channels"});
  input.Read("bits", &out->bits, {"resolution of the converter", "bits"});
  input.Read("range_v", &out->range_v, "full scale is - this .. + this");
  input.Read("reference", &out->reference,
             {{"ground", ComediReference::kGround},
              {"common", ComediReference::kCommon},
              {"differential", ComediReference::kDifferential}},
             "what a voltage is measured against");
  input.Read("acquisition", &out->acquisition,
             {{"stream", ComediAcquisition::kStream}, {"single", ComediAcquisition::kSingle}},
             "the board scans by its own clock, or each channel is read by an instruction");
  if (out->acquisition == ComediAcquisition::kStream) {
    input.Read("scan_interval_us", &out->scan_interval_us,
               "with \"stream\": from one scan to the next");
    input.Read("convert_interval_us", &out->convert_interval_us,
               "with \"stream\": from channel to channel; 0: all at the same time");
    input.Read("transfer_us", &out->transfer_us,
               "with \"stream\": longest time from a scan's end until it can be read");
  }
  for (TableReader& row : input.Rows("channel", "a strain channel, in the order of the scan")) {
    ComediStrainConfig& channel = out->channel.emplace_back();
    row.Read("strain", &channel.strain, "row of [[sensors.strain]] that it reads, from 0");
    row.Read("channel", &channel.channel, "channel of the board, from 0");
  }
}

void ReadComediOutput(TableReader output, ComediOutputConfig* out) {
  output.Read("subdevice", &out->subdevice, "number of the subdevice on the board");
  output.Read("channels", &out->channels, {"channels of the subdevice, used or not", "channels"});
  output.Read("bits", &out->bits, {"resolution of the converter", "bits"});
  output.Read("range_v", &out->range_v, "full scale is - this .. + this");
  for (TableReader& row :
       output.Rows("drive", "an amplifier that takes a voltage as its command")) {
    ComediDriveConfig& drive = out->drive.emplace_back();
    ReadJoint(row, &drive.joint);
    row.Read("channel", &drive.channel, "channel of the board, from 0");
    row.Read("motor_torque_per_volt_nm", &drive.motor_torque_per_volt_nm,
             {"amplifier and motor together, before the gear", "N m/V"});
    row.Read("gear", &drive.gear, {"turns of the motor for one of the joint", "1"});
    row.Read("sign", &drive.sign, "1 if positive volts turn the joint counter-clockwise, else -1");
    row.Read("torque_range_nm", &drive.torque_range_nm, "largest torque at the gearbox output");
  }
}

}  // namespace

void ReadComedi(TableReader row, double period_ms, ComediBoardConfig* out) {
  out->period_ms = period_ms;
  row.Read("device", &out->device, "/dev/comedi0");
  row.Read("driver", &out->driver, "name of its driver, as `comedi_board_info` prints it");
  row.Read("board", &out->board, "name of the board, from the same program");
  row.Read("instruction_us", &out->instruction_us,
           "longest single read or write: PCI about 20, USB about 2000");
  if (row.Has("input"))
    ReadComediInput(row.Table("input", "analogue inputs of the board: the strain gauges"),
                    &out->input.emplace());
  if (row.Has("output"))
    ReadComediOutput(row.Table("output", "analogue outputs of the board: the amplifiers"),
                     &out->output.emplace());
  for (TableReader& entry : row.OptionalRows("counter", "an encoder on a counter of the board")) {
    ComediCounterConfig& counter = out->counter.emplace_back();
    ReadCounter(entry, &counter.counter);
    entry.Read("subdevice", &counter.subdevice, "number of the subdevice on the board");
    entry.Read("channel", &counter.channel, "counter of the subdevice, from 0");
    entry.Read("bits", &counter.bits, {"the counter wraps at 2^bits", "bits"});
  }
  for (TableReader& entry :
       row.OptionalRows("line", "a second reading of a safety line, once a period")) {
    ComediLineConfig& line = out->line.emplace_back();
    ReadLine(entry, &line.line);
    entry.Read("subdevice", &line.subdevice, "number of the subdevice on the board");
    entry.Read("channel", &line.channel, "digital input of the subdevice, from 0");
  }
}

}  // namespace flexarm
