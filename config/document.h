#pragma once

#include <toml++/toml.h>

#include <filesystem>
#include <string>
#include <string_view>

#include "controller/files/external_file.h"

namespace flexarm {

/// Source name of the values that an override set.
inline constexpr std::string_view kOverrideSource = "--set";

/// Reads a whole text file (ReadExternalFile).
/// @throws ConfigError  one problem: missing, unreadable, not a regular file, too large, not text
std::string ReadConfigFile(const std::filesystem::path& file, const FileKind& kind = kConfigFile);

/// Parses TOML; every node of the result has `name` as its source, and its line.
/// @throws ConfigError  one problem: not UTF-8, not TOML, a key twice, nested too deep
toml::table ParseToml(std::string_view text, const std::string& name);

/// The key by which a config file stands on another one.
inline constexpr const char* kExtendsKey = "extends";
inline constexpr const char* kExtendsMeaning =
    "file that this one stands on, relative to it: what stands here replaces what stands there";

/// Reads `file` and merges it over the file that its `extends` names, recursively. Nodes keep their
/// own file and line; the key `extends` is removed.
/// @throws ConfigError  as above, or a cycle of files
toml::table LoadDocument(const std::filesystem::path& file);

/// Merges `top` into `base`: tables key by key, anything else is replaced.
void Merge(toml::table* base, toml::table&& top);

}  // namespace flexarm
