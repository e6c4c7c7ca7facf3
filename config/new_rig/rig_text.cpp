#include "config/new_rig/rig_text.h"

#include <algorithm>
#include <cstdio>
#include <vector>

#include "config/derivation/derivation.h"
#include "config/derived_keys.h"
#include "config/document.h"
#include "config/new_rig/rig_sections.h"

namespace flexarm {
namespace {

constexpr const char* kName = "the new config";

std::vector<RigSection> AllSections(const ArmDescription& arm) {
  std::vector<RigSection> sections = {{.header = "[rig]", .comment = {}, .lines = {}}};
  sections.front().Add("name", "\"" + arm.name + "\"");
  for (const auto& part : {ArmSections(arm), SensorSections(arm), LoopSections(arm)}) {
    sections.insert(sections.end(), part.begin(), part.end());
  }
  return sections;
}

std::string TextOf(const std::vector<RigSection>& sections) {
  std::string text;
  for (const RigSection& section : sections) {
    text += "\n";
    if (!section.comment.empty()) text += "# " + section.comment + "\n";
    text += section.header + "\n";
    for (const RigLine& line : section.lines) {
      text +=
          line.key + " = " + line.value + (line.source.empty() ? "" : "  # " + line.source) + "\n";
    }
  }
  return text;
}

// Adds to each section the keys that are derived for it.
void AddDerived(const TunedValues& tuned, std::vector<RigSection>* sections) {
  toml::table document = ParseToml(TextOf(*sections), kName);
  for (const DerivedValue& derived : AddDerivedKeys(&document).added) {
    const std::size_t dot = derived.key.rfind('.');
    const std::string header = "[" + derived.key.substr(0, dot) + "]";
    const auto section =
        std::find_if(sections->begin(), sections->end(),
                     [&header](const RigSection& each) { return each.header == header; });
    const auto found = tuned.find(derived.key);
    section->Add(
        derived.key.substr(dot + 1), found == tuned.end() ? TomlOf(derived) : found->second,
        found == tuned.end() ? "derived: " + derived.how : "tuned; derived: " + TomlOf(derived));
  }
}

}  // namespace

std::string TomlNumber(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  std::string number = text.data();
  if (number.find_first_of(".e") == std::string::npos) number += ".0";
  return number;
}

void RigSection::Add(std::string key, double value, std::string source) {
  Add(std::move(key), TomlNumber(value), std::move(source));
}

std::string NewRigText(const ArmDescription& arm, const TunedValues& tuned) {
  std::vector<RigSection> sections = AllSections(arm);
  AddDerived(tuned, &sections);
  return std::string(kNewRigMark) +
         ". SI units, named in the keys; joint 1 is the shoulder, "
         "in a\n# pair the first number is its own or link 1's. Angles are counter-clockwise "
         "positive, torques at\n# the gearbox output.\n#\n# Sources: \"given\" by the owner; "
         "\"derived\" from that (docs/theory/derivation.md): a line that is\n# removed follows the "
         "arm; \"tuned\" by a search; \"assumed\" values should be measured.\n" +
         TextOf(sections);
}

RigConfig NewRig(const ArmDescription& arm, const TunedValues& tuned) {
  return ParseConfig(NewRigText(arm, tuned), kName);
}

}  // namespace flexarm
