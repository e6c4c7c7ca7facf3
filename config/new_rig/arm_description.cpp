#include "config/new_rig/arm_description.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "config/config.h"
#include "config/document.h"
#include "config/overrides.h"
#include "config/problem_log.h"
#include "config/table_reader.h"
#include "model/problem_list.h"

namespace flexarm {
namespace {

constexpr std::string_view kMaterialKey = "material";

// "link1.length_m" is key length_m of table link1; a key without a dot is at the top.
std::pair<std::string, std::string> TableAndKey(std::string_view dotted) {
  const std::size_t dot = dotted.find('.');
  if (dot == std::string_view::npos) return {"", std::string(dotted)};
  return {std::string(dotted.substr(0, dot)), std::string(dotted.substr(dot + 1))};
}

// Link n has a material of its own, or that of the arm.
bool HasMaterial(const toml::table& document) {
  return document.contains(kMaterialKey) ||
         (document.at_path("link1.material") && document.at_path("link2.material"));
}

std::vector<NamedValue<const Material*>> MaterialNames() {
  std::vector<NamedValue<const Material*>> names;
  for (const Material& material : Materials()) names.push_back({material.name, &material});
  return names;
}

class Reading {
 public:
  Reading(const toml::table& document, ProblemLog* log)
      : log_(log),
        root_(&document, "", log),
        parts_{{"link1", Part("link1")},
               {"link2", Part("link2")},
               {"joint1", Part("joint1")},
               {"joint2", Part("joint2")}} {}

  ArmDescription Arm() {
    ArmDescription arm;
    arm.name = "new-rig";
    if (root_.Has("name")) root_.Read("name", &arm.name, kListedElsewhere);
    for (const ArmKey& key : ArmKeys()) ReadNumber(key, &arm);
    ReadMaterials(&arm);
    return arm;
  }

 private:
  TableReader Part(const char* name) {
    static const toml::table empty;
    return root_.Has(name) ? root_.Table(name, kListedElsewhere) : TableReader(&empty, name, log_);
  }

  void ReadNumber(const ArmKey& key, ArmDescription* arm) {
    const auto [table, name] = TableAndKey(key.key);
    TableReader& reader = table.empty() ? root_ : parts_.at(table);
    if (!reader.Has(name)) {
      if (key.required) reader.Missing(name, std::string("a number: ") + key.meaning);
      return;
    }
    double value = 0.0;
    reader.Read(name, &value, kListedElsewhere);
    if (std::isnan(value)) return;  // reported
    if (!(value >= key.least && value <= key.most)) {
      reader.Refuse(name, "must lie in " + NumberText(key.least) + " .. " + NumberText(key.most) +
                              ": " + key.meaning);
      return;
    }
    arm->number[key.key] = value;
  }

  void ReadMaterials(ArmDescription* arm) {
    const std::vector<NamedValue<const Material*>> names = MaterialNames();
    std::array<const Material*, 2> material{};
    const bool for_both = root_.Has(kMaterialKey);
    if (for_both) root_.Read(kMaterialKey, material.data(), names, kListedElsewhere);
    material[1] = material[0];
    for (std::size_t i = 0; i < 2; ++i) {
      TableReader& link = parts_.at(i == 0 ? "link1" : "link2");
      if (link.Has(kMaterialKey)) {
        link.Read(kMaterialKey, &material[i], names, kListedElsewhere);
      } else if (!for_both) {
        root_.Missing(kMaterialKey, "the material of both links, such as \"aluminium\"");
        return;
      }
      if (material[i] != nullptr) arm->material[i] = *material[i];
    }
  }

  ProblemLog* log_;
  TableReader root_;
  std::map<std::string, TableReader> parts_;
};

toml::table Document(const std::filesystem::path& file) {
  return file.empty() ? toml::table() : LoadDocument(file);
}

}  // namespace

ArmDescriptionReader::ArmDescriptionReader(std::filesystem::path file,
                                           std::vector<std::string> values)
    : file_(std::move(file)), values_(std::move(values)) {
  Document(file_);  // reports a file that cannot be read before anything is asked
}

std::vector<std::string> ArmDescriptionReader::Missing() const {
  toml::table document = Document(file_);
  ProblemLog log(file_.string(), &document);
  ApplyOverrides(values_, &document, &log);
  std::vector<std::string> missing;
  for (const ArmKey& key : ArmKeys()) {
    if (key.required && !document.at_path(key.key)) missing.emplace_back(key.key);
  }
  if (!HasMaterial(document)) missing.emplace_back(kMaterialKey);
  return missing;
}

void ArmDescriptionReader::Set(const std::string& key, const std::string& value) {
  values_.push_back(key + "=" + value);
}

ArmDescription ArmDescriptionReader::Read() const {
  toml::table document = Document(file_);
  ProblemLog log(file_.empty() ? "the arm" : file_.string(), &document);
  ApplyOverrides(values_, &document, &log);
  ArmDescription arm = Reading(document, &log).Arm();
  log.AddUnknown();
  log.ThrowIfAny();
  return arm;
}

}  // namespace flexarm
