#include "tools/plot/picture_style.h"

#include <array>
#include <sstream>

namespace flexarm {
namespace {

constexpr std::array<const char*, 8> kColours = {"#0072B2", "#D55E00", "#009E73", "#AA4499",
                                                 "#2A9FD8", "#B87A00", "#000000", "#7F7F7F"};
constexpr std::array<const char*, 5> kDashes = {"1", "(9,3)", "(3,2)", "(9,3,2,3)", "(14,4)"};

}  // namespace

const char* Colour(std::size_t i) { return kColours[i % kColours.size()]; }

std::string CurveStyle(std::size_t i, double width) {
  std::ostringstream style;
  style << "lw " << width << " dt " << kDashes[i % kDashes.size()] << " lc rgb '" << Colour(i)
        << "'";
  return style.str();
}

std::string ReferenceStyle() { return std::string("lw 1.3 dt (4,3) lc rgb '") + kInkColour + "'"; }

std::string LimitStyle() { return std::string("lw 1.5 dt (12,4) lc rgb '") + kLimitColour + "'"; }

std::string PaletteStyle() {
  return "set palette defined (0 '#440154', 1 '#3B528B', 2 '#21918C', 3 '#35B779', 4 '#8FBF1F')\n";
}

std::string PictureHead(const std::filesystem::path& output, int width, int height) {
  const std::string size = std::to_string(width) + "," + std::to_string(height);
  const std::string font = "enhanced font 'DejaVu Sans,12' background '#ffffff'";
  const std::string kind = output.extension() == ".svg" ? "svg size " + size + " dynamic "
                                                        : "pngcairo size " + size + " ";
  return "set encoding utf8\nset terminal " + kind + font +
         "\nset grid back lt 1 lc rgb '#DDDDDD' lw 1\nset border lc rgb '#808080'\n"
         "set tics textcolor rgb '" +
         kInkColour +
         "' nomirror font ',11'\nset datafile missing 'nan'\n"
         "set key outside top right horizontal samplen 2.5 spacing 1.1 font ',11'\n";
}

}  // namespace flexarm
