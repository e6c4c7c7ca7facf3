#include "config/shown_config.h"

#include "config/derived_keys.h"
#include "config/document.h"
#include "config/overrides.h"
#include "config/problem_log.h"
#include "config/toml_text.h"
#include "model/problem_list.h"

namespace flexarm {
namespace {

class Collector {
 public:
  Collector(const ProblemLog& log, const DerivedKeys& derived) : log_(log), derived_(derived) {}

  void Add(const toml::table& table, const std::string& path) {
    for (const auto& [key, node] : table) {
      const std::string name = JoinKey(path, key.str());
      const toml::array* rows = node.as_array();
      if (const toml::table* section = node.as_table()) {
        Add(*section, name);
      } else if (rows != nullptr && !rows->empty() &&
                 rows->is_homogeneous(toml::node_type::table)) {
        for (std::size_t i = 0; i < rows->size(); ++i) {
          Add(*rows->get(i)->as_table(), ProblemList::Element(name, i));
        }
      } else {
        AddValue(name, node);
      }
    }
  }

  std::vector<ShownValue> Take() { return std::move(values_); }

 private:
  void AddValue(const std::string& key, const toml::node& node) {
    ShownValue shown{.key = key, .value = ValueText(node), .origin = {}, .file = {}, .line = 0};
    for (const DerivedValue& derived : derived_.added) {
      if (derived.key == key) shown.origin = "derived: " + derived.how;
    }
    if (shown.origin.empty()) {
      const ConfigPlace place = log_.PlaceOf(key);
      shown.file = place.file;
      shown.line = place.line;
      shown.origin = place.file + (place.line > 0 ? ":" + std::to_string(place.line) : "");
    }
    values_.push_back(std::move(shown));
  }

  const ProblemLog& log_;
  const DerivedKeys& derived_;
  std::vector<ShownValue> values_;
};

}  // namespace

std::vector<ShownValue> ShownConfig(const std::filesystem::path& file,
                                    const std::vector<std::string>& overrides) {
  toml::table document = LoadDocument(file);
  ProblemLog log(file.string(), &document);
  ApplyOverrides(overrides, &document, &log);
  const DerivedKeys derived = AddDerivedKeys(&document);
  Collector collector(log, derived);
  collector.Add(document, "");
  return collector.Take();
}

}  // namespace flexarm
