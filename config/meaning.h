#pragma once

#include <string_view>

namespace flexarm {

/// What a key of a config means, as `flexarm config reference` prints it. It stands where the key
/// is read, so that no key is without one.
struct Meaning {
  // NOLINTNEXTLINE(google-explicit-constructor): a text is the usual meaning
  constexpr Meaning(const char* said) : text(said) {}
  constexpr Meaning(const char* said, const char* in) : text(said), unit(in) {}

  std::string_view text;  ///< one line, without a full stop
  std::string_view unit;  ///< "N m"; empty: that of the key's name, or none
};

/// Of a key that the reference does not list: one of a file that is no config of a user, or one
/// that another reader lists.
inline constexpr Meaning kListedElsewhere{""};

}  // namespace flexarm
