#include "config/rig_sections.h"

namespace flexarm {
namespace {

void ReadEncoder(TableReader row, EncoderConfig* out) {
  row.Read<int>("joint", &out->counter, {{"hub1", 0}, {"hub2", 1}, {"rotor1", 2}, {"rotor2", 3}},
                "the angle that it measures; both hubs need one");
  row.Read("counts_per_turn", &out->counts_per_turn,
           {"counts per turn of the joint, quadrature and gear included", "counts/turn"});
  row.Read("counter_bits", &out->counter_bits, {"the counter wraps at 2^bits", "bits"});
  row.Read("sign", &out->sign, "1 if it counts up counter-clockwise, else -1");
}

void ReadStrainChannel(TableReader row, StrainChannelConfig* out) {
  row.Read("link", &out->link, "the link that the gauge is on");
  row.Read("position_m", &out->position_m, "distance of the gauge from the root of its link");
  row.Read(
      "face", &out->face,
      "1 for the face that is stretched when the tip bends counter-clockwise, -1 for the other");
  row.Read("gain_v_per_unit", &out->gain_v_per_unit,
           {"volts at the converter for a strain of 1, bridge and amplifier together", "V"});
  row.Read("offset_counts", &out->offset_counts,
           "counts without strain; `flexarm tare` measures what changes");
}

void ReadTipAccelerometer(TableReader sensor, TipAccelerometerConfig* out) {
  sensor.Read("range_m_s2", &out->range_m_s2, "full scale is - this .. + this");
  sensor.Read("converter_bits", &out->converter_bits, {"resolution of the converter", "bits"});
  sensor.Read("noise_counts", &out->noise_counts, "standard deviation before quantising");
  sensor.Read("filter_hz", &out->filter_hz, "corner of the first-order analogue filter");
}

void ReadStrainInput(TableReader input, StrainInputConfig* out) {
  input.Read("converter_bits", &out->converter_bits, {"resolution of the converter", "bits"});
  input.Read("range_v", &out->range_v, "full scale is - this .. + this");
  input.Read("filter_hz", &out->filter_hz, "corner of the analogue low-pass filter; 0: none");
  input.ReadIfGiven(
      "filter_damping", &out->filter_damping,
      {"damping ratio of a second-order filter; 0: the filter is of first order", "1"});
  input.Read("noise_counts", &out->noise_counts, "standard deviation before quantising");
}

}  // namespace

void ReadSensors(TableReader sensors, SensorConfig* out) {
  for (const TableReader& row :
       sensors.Rows("encoder", "an encoder and its counter; those of the rotors may be absent")) {
    ReadEncoder(row, &out->encoder.emplace_back());
  }
  for (const TableReader& row : sensors.Rows("strain", "a strain gauge or half bridge")) {
    ReadStrainChannel(row, &out->strain.emplace_back());
  }
  ReadStrainInput(
      sensors.Table("strain_input", "amplifier and converter, the same for all strain channels"),
      &out->strain_input);
  if (sensors.Has("tip_accelerometer")) {
    ReadTipAccelerometer(
        sensors.Table("tip_accelerometer",
                      "an accelerometer at the tip, of a simulated rig; docs/hardware.md"),
        &out->tip_accelerometer.emplace());
  }
}

}  // namespace flexarm
