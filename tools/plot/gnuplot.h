#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "controller/files/write_file.h"

namespace flexarm {

/// Colour of the i-th curve, as #RRGGBB, from the palette of Okabe and Ito (safe for colour-blind
/// readers).
const char* Colour(std::size_t i);

/// A path quoted for gnuplot. In single quotes gnuplot runs no commands.
std::string QuotedPath(const std::string& path);

/// A text quoted for gnuplot, with its special characters taken literally.
std::string Quoted(const std::string& text);

/// "set terminal" for a .png or .svg of the given size in pixels.
std::string TerminalFor(const std::filesystem::path& output, int width, int height);

/// Rules for a picture that a user named: one that flexarm drew is replaced.
OutputRules PictureRules(std::vector<std::filesystem::path> inputs, bool overwrite);

/// Rules for a picture in a folder whose files may be replaced.
OutputRules ReplacedPicture();

/// Draws a script that begins with TerminalFor into a file.
/// @throws std::runtime_error if gnuplot is missing or fails; InputError as WriteFile does
void DrawPicture(const std::string& script, const std::filesystem::path& output,
                 const OutputRules& rules = ReplacedPicture());

}  // namespace flexarm
