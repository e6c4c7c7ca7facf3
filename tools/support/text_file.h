#pragma once

#include <filesystem>
#include <string>

namespace flexarm {

/// Writes a text file, in the place of what was there.
/// @throws InputError  it cannot be written
void WriteText(const std::filesystem::path& file, const std::string& text);

}  // namespace flexarm
