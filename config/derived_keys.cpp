#include "config/derived_keys.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <optional>
#include <utility>

#include "config/document.h"
#include "config/problem_log.h"
#include "config/rig_binding.h"
#include "config/toml_text.h"

namespace flexarm {
namespace {

bool IsUsable(const TuningBasis& basis) {
  const std::array<double, 2> length_m = {basis.arm.link[0].length_m(),
                                          basis.arm.link[1].length_m()};
  const auto positive = [](const std::array<double, 2>& pair) {
    return pair[0] > 0 && pair[1] > 0;
  };
  return basis.arm.Problems().empty() && basis.sensors.Problems(length_m).empty() &&
         basis.period_s > 0.0 && positive(basis.torque_limit_nm) &&
         basis.payload_range_kg[0] >= 0.0 && basis.payload_range_kg[0] <= basis.payload_range_kg[1];
}

bool IsFinite(const std::vector<DerivedValue>& values) {
  return std::all_of(values.begin(), values.end(), [](const DerivedValue& derived) {
    return std::all_of(derived.value.begin(), derived.value.end(),
                       [](double x) { return std::isfinite(x); });
  });
}

// Nothing if the document lacks what the derivation needs: the reading of the config reports it.
std::optional<std::vector<DerivedValue>> Derived(const toml::table& document) {
  ProblemLog unread("", &document);
  TuningBasis basis{};
  try {
    ReadTuningBasis(TableReader(&document, "", &unread), &basis);
    unread.ThrowIfAny();
    if (!IsUsable(basis)) return std::nullopt;
    std::vector<DerivedValue> values = DeriveTuning(basis);
    if (!IsFinite(values)) return std::nullopt;
    return values;
  } catch (const std::exception&) {  // an arm without mode shapes
    return std::nullopt;
  }
}

toml::array ArrayOf(const std::vector<double>& values) {
  toml::array array;
  for (const double value : values) array.push_back(value);
  return array;
}

// The section that the key belongs to is there: a section that is missing as a whole is reported.
bool HasSection(const toml::table& document, const std::string& key) {
  return document.get_as<toml::table>(key.substr(0, key.find('.'))) != nullptr;
}

}  // namespace

std::string TomlOf(const DerivedValue& derived) {
  if (derived.is_list) return ValueText(ArrayOf(derived.value));
  if (derived.is_whole) return std::to_string(std::lround(derived.value.front()));
  return ValueText(toml::value<double>(derived.value.front()));
}

std::vector<DerivedValue> DerivedValues(const toml::table& document) {
  return Derived(document).value_or(std::vector<DerivedValue>{});
}

DerivedKeys AddDerivedKeys(toml::table* document) {
  const auto absent = [document](const std::string& key) {
    return HasSection(*document, key) && !document->at_path(key);
  };
  static const std::vector<std::string> derivable = DerivableKeys();
  if (std::none_of(derivable.begin(), derivable.end(), absent)) return {};
  DerivedKeys keys;
  const std::optional<std::vector<DerivedValue>> derived = Derived(*document);
  if (!derived) {
    std::copy_if(derivable.begin(), derivable.end(), std::back_inserter(keys.waiting), absent);
    return keys;
  }
  std::string text;
  for (const DerivedValue& value : *derived) {
    if (!absent(value.key)) continue;
    text += value.key + " = " + TomlOf(value) + "\n";
    keys.added.push_back(value);
  }
  Merge(document, ParseToml(text, std::string(kDerivedSource)));
  return keys;
}

}  // namespace flexarm
