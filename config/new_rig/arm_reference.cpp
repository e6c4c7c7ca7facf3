#include "config/new_rig/arm_reference.h"

#include "config/key_units.h"
#include "config/new_rig/arm_description.h"
#include "model/problem_list.h"

namespace flexarm {
namespace {

constexpr const char* kNumber = "a finite number";

// "link1" of "link1.length_m"; "" of a key above the tables.
std::string TableOf(const std::string& path) {
  const std::size_t dot = path.find('.');
  return dot == std::string::npos ? "" : path.substr(0, dot);
}

std::string NameOf(const std::string& path) { return path.substr(path.find('.') + 1); }

// Without the unit at its end, which has a column of its own.
std::string WithoutUnit(std::string meaning, const std::string& unit) {
  const std::string end = ", " + unit;
  if (!unit.empty() && meaning.ends_with(end)) meaning.resize(meaning.size() - end.size());
  return meaning;
}

ListedKey Listed(const ArmKey& key) {
  const std::string path = key.key, unit = UnitOfName(path);
  return {.path = path,
          .table = TableOf(path),
          .name = NameOf(path),
          .type = kNumber,
          .unit = unit,
          .meaning = WithoutUnit(key.meaning, unit),
          .is_required = key.required,
          .without = key.otherwise,
          .rules = {"must lie in " + NumberText(key.least) + " .. " + NumberText(key.most) + ": " +
                    key.meaning}};
}

ListedKey Word(const std::string& path, const std::string& type, const std::string& meaning,
               const std::string& without) {
  return {.path = path,
          .table = TableOf(path),
          .name = NameOf(path),
          .type = type,
          .unit = {},
          .meaning = meaning,
          .is_required = without.empty(),
          .without = without,
          .rules = {}};
}

std::string MaterialType() {
  std::string type = "one of";
  for (const Material& material : Materials()) type += " \"" + std::string(material.name) + "\"";
  return type;
}

ListedTable Table(const std::string& name, const std::string& meaning) {
  return {.name = "[" + name + "]", .path = name, .meaning = meaning, .is_optional = false};
}

}  // namespace

KeyListing ArmReference() {
  KeyListing listing{.tables = {Table("link1", "upper arm"), Table("link2", "forearm"),
                                Table("joint1", "shoulder"), Table("joint2", "elbow")},
                     .keys = {}};
  listing.keys.push_back(Word("name", "a string", "name of the rig", "new-rig"));
  listing.keys.push_back(Word("material", MaterialType(), "material of both links",
                              "link1.material and link2.material"));
  for (const char* link : {"link1", "link2"}) {
    listing.keys.push_back(
        Word(std::string(link) + ".material", MaterialType(), "material of this link", "material"));
  }
  for (const ArmKey& key : ArmKeys()) listing.keys.push_back(Listed(key));
  return listing;
}

}  // namespace flexarm
