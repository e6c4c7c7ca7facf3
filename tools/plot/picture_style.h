#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace flexarm {

// The style of all pictures: fonts, grid, colours and dashes. The background is white also on dark
// pages; curves differ by their dashes as well as by their colours, so they can be told apart in
// print and by colour-blind readers.

inline constexpr const char* kInkColour = "#202020";    ///< text, references
inline constexpr const char* kMutedColour = "#606060";  ///< notes, axes
inline constexpr const char* kLimitColour = "#B03000";  ///< limits, trips
inline constexpr const char* kEventColour = "#7A4E9F";  ///< events on the time axis

/// Colour of the i-th curve, as #RRGGBB, from the palette of Okabe and Ito (safe for colour-blind
/// readers).
const char* Colour(std::size_t i);

/// Width, dash and colour of the i-th curve for gnuplot: "lw 2 dt 1 lc rgb '#0072B2'".
std::string CurveStyle(std::size_t i, double width = 2.0);

/// The same for a reference, which lies over the curve that follows it.
std::string ReferenceStyle();

/// The same for a limit.
std::string LimitStyle();

// The same styles as attributes of an SVG line.
std::string SvgCurveStyle(std::size_t i, double width = 2.0);
std::string SvgReferenceStyle();
std::string SvgLimitStyle();

/// Colours of increasing values, dark to light, for gnuplot: legible on white up to the last one.
std::string PaletteStyle();

/// Begins the script of a picture: terminal (.png or .svg), size in pixels, fonts, grid. The legend
/// is above each plot, outside the data.
std::string PictureHead(const std::filesystem::path& output, int width, int height);

}  // namespace flexarm
