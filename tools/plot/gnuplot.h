#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace flexarm {

/// Colour of the i-th curve, as #RRGGBB, from the palette of Okabe and Ito (safe for colour-blind
/// readers).
const char* Colour(std::size_t i);

/// A path quoted for gnuplot. In single quotes gnuplot runs no commands.
std::string QuotedPath(const std::string& path);

/// A text quoted for gnuplot, with its special characters taken literally.
std::string Quoted(const std::string& text);

/// "set terminal" and "set output" for a .png or .svg of the given size in pixels.
std::string TerminalFor(const std::filesystem::path& output, int width, int height);

/// Pipes a script through gnuplot. @throws std::runtime_error if gnuplot is missing or fails
void RunGnuplot(const std::string& script);

}  // namespace flexarm
