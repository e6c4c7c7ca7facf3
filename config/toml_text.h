#pragma once

#include <toml++/toml.h>

#include <string>

namespace flexarm {

/// A value as one line of TOML, with numbers in their shortest exact form; a table is "{...}".
std::string ValueText(const toml::node& node);

/// A document as TOML, with keys in alphabetical order. Reading the text gives the same values to
/// the last bit, and equal documents have equal texts.
std::string DocumentText(const toml::table& document);

/// `key` as it may stand in a dotted path: quoted unless it is a bare TOML key.
std::string KeyText(std::string_view key);

}  // namespace flexarm
