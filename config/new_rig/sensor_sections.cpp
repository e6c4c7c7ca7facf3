#include <cmath>

#include "config/new_rig/rig_sections.h"

namespace flexarm {
namespace {

RigSection Encoder(const std::string& joint, double counts_per_turn, const char* source) {
  RigSection section{.header = "[[sensors.encoder]]", .comment = {}, .lines = {}};
  section.Add("joint", "\"" + joint + "\"");
  section.Add("counts_per_turn", counts_per_turn, source);
  section.Add("counter_bits", "32");
  section.Add("sign", "1", "-1 if it counts clockwise");
  return section;
}

// One gauge sits near the clamp, where every mode strains the link and the first one most; more are
// in the middles of equal parts, as on the thesis's rig.
double GaugePosition_m(double length_m, int gauge, int gauges) {
  constexpr double kNearClamp = 0.1;
  return length_m * (gauges == 1 ? kNearClamp : (gauge + 0.5) / gauges);
}

}  // namespace

std::vector<RigSection> SensorSections(const ArmDescription& arm) {
  std::vector<RigSection> sections;
  for (const char* joint : {"1", "2"}) {
    const std::string of = std::string("joint") + joint + ".";
    sections.push_back(Encoder(std::string("hub") + joint, arm.At(of + "encoder_counts_per_turn"),
                               "given: of the joint's axis"));
  }
  for (const char* joint : {"1", "2"}) {
    const std::string of = std::string("joint") + joint + ".";
    if (!arm.Has(of + "rotor_encoder_counts_per_turn")) continue;
    sections.push_back(
        Encoder(std::string("rotor") + joint,
                arm.At(of + "rotor_encoder_counts_per_turn") * arm.Or(of + "gear", 1.0),
                "given, times the gear: per turn of the joint"));
  }
  constexpr double kRange_v = 10.0;
  RigSection input{.header = "[sensors.strain_input]", .comment = {}, .lines = {}};
  input.Add("converter_bits", std::to_string(std::lround(arm.Or("converter_bits", 12.0))),
            arm.Has("converter_bits") ? "given" : "assumed");
  input.Add("range_v", kRange_v, "assumed");
  input.Add("filter_hz", arm.Or("gauge_filter_hz", 0.4 * arm.At("rate_hz")),
            arm.Has("gauge_filter_hz") ? "given" : "0.4 of the rate, against aliasing");
  input.Add("noise_counts", 1.0, "assumed");
  sections.push_back(input);
  const int gauges = static_cast<int>(std::lround(arm.At("gauges_per_link")));
  for (std::size_t link = 0; link < 2; ++link) {
    const std::string of = "link" + std::to_string(link + 1) + ".";
    const double limit = arm.Or(of + "strain_limit", arm.material[link].strain_limit);
    for (int gauge = 0; gauge < gauges; ++gauge) {
      RigSection row{.header = "[[sensors.strain]]", .comment = {}, .lines = {}};
      row.Add("link", std::to_string(link + 1));
      row.Add("position_m", GaugePosition_m(arm.At(of + "length_m"), gauge, gauges),
              "from the root; measure it");
      row.Add("face", "1", "the face that reads +(h/2) w''; -1: the other");
      row.Add("gain_v_per_unit", kRange_v / (1.05 * limit),
              "full scale 1.05 times the strain limit; set the amplifier to it");
      row.Add("offset_counts", 0.0, "`flexarm tare` measures it");
      sections.push_back(row);
    }
  }
  return sections;
}

}  // namespace flexarm
