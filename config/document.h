#pragma once

#include <toml++/toml.h>

#include <filesystem>
#include <string>
#include <string_view>

namespace flexarm {

/// Stands for the file of everything that an override set.
inline constexpr std::string_view kOverrideSource = "--set";

/// Reads a whole text file.
/// @throws ConfigError  one problem: not there, a directory, unreadable, empty, too large
std::string ReadConfigFile(const std::filesystem::path& file);

/// Parses TOML; every node of the result knows `name` and its line.
/// @throws ConfigError  one problem: not UTF-8, not TOML, a key twice, nested too deep
toml::table ParseToml(std::string_view text, const std::string& name);

/// Reads `file` on top of what its `extends` names, recursively. Nodes keep their own file and
/// line; the key `extends` itself is gone.
/// @throws ConfigError  as above, or a circle of files
toml::table LoadDocument(const std::filesystem::path& file);

/// Lays `top` over `base`: tables are merged key by key, anything else is replaced.
void Merge(toml::table* base, toml::table&& top);

}  // namespace flexarm
