#include "config/following_keys.h"

#include "config/derived_keys.h"
#include "config/document.h"
#include "config/toml_text.h"

namespace flexarm {
namespace {

toml::table DocumentOf(const RigConfig& config) { return ParseToml(config.text, config.rig_name); }

std::string TextAt(const toml::table& document, const std::string& key) {
  const toml::node_view<const toml::node> node = document.at_path(key);
  return node.node() == nullptr ? std::string() : ValueText(*node.node());
}

}  // namespace

std::vector<ChangedValue> FollowingKeys(const RigConfig& before, const RigConfig& after) {
  const toml::table own = DocumentOf(before);
  const std::vector<DerivedValue> was = DerivedValues(own);
  const std::vector<DerivedValue> is = DerivedValues(DocumentOf(after));
  std::vector<ChangedValue> changed;
  for (std::size_t i = 0; i < was.size() && i < is.size(); ++i) {  // the same keys
    const std::string old = TomlOf(was[i]), found = TomlOf(is[i]);
    if (old == found || TextAt(own, was[i].key) != old) continue;
    changed.push_back({.key = was[i].key, .before = old, .after = found, .how = is[i].how});
  }
  return changed;
}

std::string ValueTextAt(const RigConfig& config, const std::string& key) {
  return TextAt(DocumentOf(config), LineKeyOf(key));
}

std::string LineKeyOf(const std::string& key) {
  return key.ends_with(']') ? key.substr(0, key.rfind('[')) : key;
}

}  // namespace flexarm
