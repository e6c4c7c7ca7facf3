#include "tools/report/arm_picture.h"

#include <cmath>
#include <sstream>

#include "model/units.h"
#include "tools/plot/gnuplot.h"
#include "tools/plot/picture_style.h"

namespace flexarm {
namespace {

constexpr double kElbow_deg = 40.0;

}  // namespace

void DrawArm(const RigConfig& config, const std::filesystem::path& output) {
  const double length1 = config.arm.link[0].length_m(), length2 = config.arm.link[1].length_m();
  const double c = std::cos(kElbow_deg * kRadPerDeg), s = std::sin(kElbow_deg * kRadPerDeg);
  const double reach = length1 + length2, margin = 0.08 * reach;
  const double tip_x = length1 + c * length2, tip_y = s * length2;
  constexpr int kWidth = 1000, kBorder = 150;
  const double aspect = (tip_y + 2 * margin) / (tip_x + 2 * margin);
  std::ostringstream script;
  script << PictureHead(output, kWidth, kBorder + static_cast<int>(kWidth * aspect))
         << "$link1 << EOD\n0 0\n"
         << length1 << " 0\nEOD\n$link2 << EOD\n"
         << length1 << " 0\n"
         << tip_x << ' ' << tip_y << "\nEOD\n$joint << EOD\n0 0\n"
         << length1 << " 0\nEOD\n$tip << EOD\n"
         << tip_x << ' ' << tip_y << "\nEOD\n$gauge << EOD\n";
  for (const StrainChannelConfig& channel : config.sensors.strain) {
    const double u = channel.position_m;
    const bool first = channel.link == 1;
    script << (first ? u : length1 + c * u) << ' ' << (first ? 0.0 : s * u) << '\n';
  }
  script << "EOD\nset size ratio -1\nset xrange [" << -margin << ':' << tip_x + margin
         << "]\nset yrange [" << -margin << ':' << tip_y + margin
         << "]\nset xlabel 'x, m'\nset ylabel 'y, m'\nplot $link1 with lines lw 6 lc rgb '"
         << Colour(0) << "' title 'link 1', $link2 with lines lw 6 lc rgb '" << Colour(2)
         << "' title 'link 2', $gauge with points pt 5 ps 0.9 lc rgb '" << Colour(5)
         << "' title 'gauges', $joint with points pt 7 ps 3 lc rgb '#404040' title 'joints', $tip "
            "with points pt 7 ps 2 lc rgb '"
         << Colour(1) << "' title 'payload'\n";
  DrawPicture(script.str(), output);
}

}  // namespace flexarm
