#include "tools/sweep/plant_variant.h"

#include <array>
#include <cstdio>

#include "controller/runlog/errors.h"

namespace flexarm {
namespace {

constexpr std::array<const char*, 7> kPlantSections = {"arm.",    "link1.",   "link2.", "joint1.",
                                                       "joint2.", "sensors.", "sim."};

std::string Times(const RigConfig& config, const std::string& key, double factor) {
  std::array<char, 32> value{};
  std::snprintf(value.data(), value.size(), "%.17g", *NumberAt(config, key) * factor);
  return key + "=" + value.data();
}

std::vector<std::string> BothJoints(const RigConfig& config, const std::string& key,
                                    double factor) {
  return {Times(config, "joint1." + key, factor), Times(config, "joint2." + key, factor)};
}

// The bending stiffness of every section, by the key that the section has for it.
std::vector<std::string> SofterLinks(const RigConfig& config, double factor) {
  std::vector<std::string> overrides;
  for (std::size_t link = 0; link < 2; ++link) {
    const std::string name = "link" + std::to_string(link + 1) + ".section[";
    const std::vector<BeamSection>& section = config.arm.link[link].section;
    for (std::size_t i = 0; i < section.size(); ++i) {
      const char* key =
          section[i].has_cross_section ? "youngs_modulus_pa" : "bending_stiffness_nm2";
      overrides.push_back(Times(config, name + std::to_string(i) + "]." + key, factor));
    }
  }
  return overrides;
}

std::vector<std::string> Together(const RigConfig& config) {
  std::vector<std::string> overrides = {"joint2.backlash_rad=0.0087266462599716477",
                                        "joint2.backlash_model=dead_zone",
                                        "arm.damping=modal",
                                        "link1.damping_ratio=0.02",
                                        "link2.damping_ratio=0.02",
                                        "sim.lost_frame_fraction=0.05"};
  for (const auto& more :
       {BothJoints(config, "coulomb_friction_nm", 2.0),
        BothJoints(config, "stiffness_nm_per_rad", 0.85), SofterLinks(config, 0.95)}) {
    overrides.insert(overrides.end(), more.begin(), more.end());
  }
  return overrides;
}

}  // namespace

const std::vector<PlantVariant>& PlantVariants() {
  static const std::vector<PlantVariant> variants = {
      {"nominal", "as the config says"},
      {"backlash", "1 degree of backlash in the elbow's gears"},
      {"friction-x3", "three times the Coulomb friction in both joints"},
      {"soft-joints", "stiffness of both joints 30 % less"},
      {"soft-links", "Young's modulus of both links 10 % less"},
      {"modal-damping", "3 % damping in every bending mode"},
      {"together",
       "half a degree of backlash, friction x 2, joints 15 % and links 5 % softer, 2 % damping, "
       "one "
       "frame in twenty lost"}};
  return variants;
}

std::vector<std::string> VariantOverrides(const RigConfig& config, const std::string& name) {
  if (name == "nominal") return {};
  if (name == "backlash") {
    return {"joint2.backlash_rad=0.017453292519943295", "joint2.backlash_model=dead_zone"};
  }
  if (name == "friction-x3") return BothJoints(config, "coulomb_friction_nm", 3.0);
  if (name == "soft-joints") return BothJoints(config, "stiffness_nm_per_rad", 0.7);
  if (name == "soft-links") return SofterLinks(config, 0.9);
  if (name == "modal-damping") {
    return {"arm.damping=modal", "link1.damping_ratio=0.03", "link2.damping_ratio=0.03"};
  }
  if (name == "together") return Together(config);  // docs/theory/payload.md 6.3
  std::string known;
  for (const PlantVariant& variant : PlantVariants()) {
    known += std::string(known.empty() ? "" : ", ") + variant.name;
  }
  throw InputError("plant variant \"" + name + "\": expected one of " + known);
}

RigConfig PlantWith(const RigConfig& config, const std::vector<std::string>& overrides) {
  for (const std::string& text : overrides) {
    bool of_plant = false;
    for (const char* section : kPlantSections) of_plant |= text.starts_with(section);
    if (of_plant) continue;
    throw InputError(text +
                     ": is not a key of the plant; expected one of the sections arm, link1, " +
                     "link2, joint1, joint2, sensors, sim");
  }
  return WithOverrides(config, overrides);
}

}  // namespace flexarm
