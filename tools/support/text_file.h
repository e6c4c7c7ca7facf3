#pragma once

#include <filesystem>
#include <string>

namespace flexarm {

/// Writes a text file; replaces an existing one.
/// @throws InputError  the file cannot be written
void WriteText(const std::filesystem::path& file, const std::string& text);

}  // namespace flexarm
