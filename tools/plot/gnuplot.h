#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "controller/files/write_file.h"

namespace flexarm {

/// A path quoted for gnuplot. In single quotes gnuplot runs no commands.
std::string QuotedPath(const std::string& path);

/// A text quoted for gnuplot, with its special characters taken literally.
std::string Quoted(const std::string& text);

/// Rules for a picture that a user named: one that flexarm drew is replaced.
OutputRules PictureRules(std::vector<std::filesystem::path> inputs, bool overwrite);

/// Rules for a picture in a folder whose files may be replaced.
OutputRules ReplacedPicture();

/// Draws a script that begins with PictureHead into a file.
/// @throws std::runtime_error if gnuplot is missing or fails; InputError as WriteFile does
void DrawPicture(const std::string& script, const std::filesystem::path& output,
                 const OutputRules& rules = ReplacedPicture());

}  // namespace flexarm
