#include "tools/plot/picture_style.h"

#include <array>
#include <sstream>

namespace flexarm {
namespace {

constexpr std::array<const char*, 8> kColours = {"#0072B2", "#D55E00", "#009E73", "#AA4499",
                                                 "#2A9FD8", "#B87A00", "#000000", "#7F7F7F"};
constexpr std::array<const char*, 5> kDashes = {"", "9,3", "3,2", "9,3,2,3", "14,4"};

struct Stroke {
  double width;
  const char* dashes;  // lengths of dash and gap in turn; "": solid
  const char* colour;
};
constexpr Stroke kReferenceStroke{1.3, "4,3", kInkColour};
constexpr Stroke kLimitStroke{1.5, "12,4", kLimitColour};

Stroke CurveStroke(std::size_t i, double width) {
  return {width, kDashes[i % kDashes.size()], Colour(i)};
}

std::string GnuplotStyle(const Stroke& stroke) {
  std::ostringstream style;
  const std::string dashes = stroke.dashes;
  style << "lw " << stroke.width << " dt " << (dashes.empty() ? "1" : "(" + dashes + ")")
        << " lc rgb '" << stroke.colour << "'";
  return style.str();
}

std::string SvgStyle(const Stroke& stroke) {
  std::ostringstream style;
  style << "fill=\"none\" stroke=\"" << stroke.colour << "\" stroke-width=\"" << stroke.width
        << "\"";
  if (*stroke.dashes != '\0') style << " stroke-dasharray=\"" << stroke.dashes << "\"";
  return style.str();
}

}  // namespace

const char* Colour(std::size_t i) { return kColours[i % kColours.size()]; }

std::string CurveStyle(std::size_t i, double width) { return GnuplotStyle(CurveStroke(i, width)); }

std::string ReferenceStyle() { return GnuplotStyle(kReferenceStroke); }

std::string LimitStyle() { return GnuplotStyle(kLimitStroke); }

std::string SvgCurveStyle(std::size_t i, double width) { return SvgStyle(CurveStroke(i, width)); }

std::string SvgReferenceStyle() { return SvgStyle(kReferenceStroke); }

std::string SvgLimitStyle() { return SvgStyle(kLimitStroke); }

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
