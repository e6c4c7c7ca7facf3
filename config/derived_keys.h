#pragma once

#include <toml++/toml.h>

#include <string>
#include <string_view>
#include <vector>

#include "config/derivation/derivation.h"

namespace flexarm {

/// Source name of the values that were derived.
inline constexpr std::string_view kDerivedSource = "derived";

/// The value as TOML.
std::string TomlOf(const DerivedValue& derived);

/// What became of the derivable keys that a document leaves out.
struct DerivedKeys {
  std::vector<DerivedValue> added;  ///< now in the document
  /// Keys that could not be derived, because what they depend on is missing or wrong.
  std::vector<std::string> waiting;
};

/// What every derivable key would be, whether the document has it or not; empty if the document
/// lacks what they depend on.
std::vector<DerivedValue> DerivedValues(const toml::table& document);

/// Adds to the document the keys that it leaves out and that can be derived.
DerivedKeys AddDerivedKeys(toml::table* document);

}  // namespace flexarm
