#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace flexarm {

/// Colour of the i-th curve, as #RRGGBB; told apart by everybody (Okabe and Ito).
const char* Colour(std::size_t i);

/// A path as gnuplot takes it. In single quotes gnuplot runs no commands.
std::string QuotedPath(const std::string& path);

/// A text as gnuplot prints it, its special characters taken literally.
std::string Quoted(const std::string& text);

/// "set terminal" and "set output" for a .png or .svg of so many pixels.
std::string TerminalFor(const std::filesystem::path& output, int width, int height);

/// Pipes a script through gnuplot. @throws std::runtime_error if gnuplot is missing or fails
void RunGnuplot(const std::string& script);

}  // namespace flexarm
