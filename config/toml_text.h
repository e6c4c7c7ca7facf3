#pragma once

#include <toml++/toml.h>

#include <string>

namespace flexarm {

/// A value as one line of TOML, numbers in their shortest exact form; a table is "{...}".
std::string ValueText(const toml::node& node);

/// A document as TOML, keys in alphabetical order. Reading it again gives the same values to the
/// last bit: equal documents have equal texts.
std::string DocumentText(const toml::table& document);

/// `key` as it may stand in a dotted path: quoted unless it is a bare TOML key.
std::string KeyText(std::string_view key);

}  // namespace flexarm
