#include "tools/analysis/reduction_figures.h"

#include <array>
#include <iomanip>
#include <sstream>

#include "controller/files/write_file.h"
#include "model/units.h"
#include "tools/analysis/reduction_report.h"
#include "tools/plot/gnuplot.h"
#include "tools/plot/picture_style.h"

namespace flexarm {
namespace {

constexpr int kRatePoints = 20;

struct Curve {
  const char* file;
  double theta2_deg, theta1_rate_rad_s, theta2_rate_rad_s;
};

// The motions in the captions of figures 6.3 to 6.5, corrected by docs/theory/errata.md 5.
constexpr std::array<Curve, 3> kCurves = {{{"figure-6.3.png", 0.0, 0.0, 0.0},
                                           {"figure-6.4.png", 45.0, -1.0, 3.0},
                                           {"figure-6.5.png", 90.0, -4.0, -6.0}}};

struct Surface {
  const char* file;
  double theta2_deg;
};

// The elbow angles in the captions of figures 6.6 to 6.9.
constexpr std::array<Surface, 4> kSurfaces = {{{"figure-6.6.png", 0.0},
                                               {"figure-6.7.png", 28.4},
                                               {"figure-6.8.png", 61.6},
                                               {"figure-6.9.png", 90.0}}};

std::string Caption(double theta2_deg, const std::string& rest, ModalScaling scaling) {
  std::ostringstream text;
  text << "elbow " << theta2_deg << " deg" << rest << ", phi scaled by " << ToString(scaling);
  return text.str();
}

// The curves of both links; `value` is the gnuplot expression of column c.
std::string BothLinks(const std::string& value) {
  std::ostringstream curves;
  for (const int link : {1, 2}) {
    curves << (link == 2 ? ", " : "") << "c=" << link + 1 << " $data using 1:" << value
           << " with linespoints pt " << (link == 1 ? 7 : 4) << ' '
           << CurveStyle(static_cast<std::size_t>(link - 1)) << " title 'link " << link << "'";
  }
  return curves.str() + "\n";
}

void DrawCurve(const ArmModel& model, const ReductionOptions& options, const Curve& curve,
               const std::filesystem::path& output) {
  const ArmReduction reduction = ReduceArm(
      model, {curve.theta2_deg * kRadPerDeg, curve.theta1_rate_rad_s, curve.theta2_rate_rad_s},
      options.scaling, options.rigid_below_rad2_s2);
  std::ostringstream script;
  script << PictureHead(output, 1100, 500) << std::setprecision(10) << "$data << EOD\n";
  for (Eigen::Index k = 0; k < model.mode_count().link1; ++k) {
    script << k + 1;
    for (const LinkContribution& link : reduction.link) script << ' ' << link.epsilon_percent[k];
    script << '\n';
  }
  std::ostringstream rates;
  rates << ", rates " << curve.theta1_rate_rad_s << " and " << curve.theta2_rate_rad_s << " rad/s";
  script << "EOD\nset multiplot layout 1,2 title "
         << Quoted("Power of the first k modes: " +
                   Caption(curve.theta2_deg, rates.str(), options.scaling))
         << "\nset xlabel 'modes k'\nset xrange [1:" << model.mode_count().link1
         << "]\nset ylabel 'contribution of the first k modes, %'\nplot "
         << BothLinks("(column(c))")
         << "set logscale y\nset format y '10^{%T}'\nset yrange [*:*]\n"
            "set ylabel 'contribution of the other modes, %'\nplot "
         << BothLinks("(100-column(c))") << "unset multiplot\n";
  DrawPicture(script.str(), output);
}

// Two views per link: a map, from which values can be read, and the surface of the thesis.
void DrawSurface(const ArmModel& model, const ReductionOptions& options, const Surface& surface,
                 const std::filesystem::path& output) {
  ReductionGrid grid;
  grid.cells = kRatePoints;
  std::vector<NominalMotion> motions;
  for (int j = 0; j < kRatePoints; ++j) {
    for (int k = 0; k < kRatePoints; ++k) {
      motions.push_back(grid.Centre(0, j, k));
      motions.back().theta2_rad = surface.theta2_deg * kRadPerDeg;
    }
  }
  const std::vector<ReductionCell> cells = ReduceCells(model, motions, options);
  std::ostringstream script;
  script << PictureHead(output, 1200, 950) << std::setprecision(10) << "$data << EOD\n";
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (i > 0 && i % kRatePoints == 0) script << '\n';
    script << cells[i].motion.theta1_rate_rad_s << ' ' << cells[i].motion.theta2_rate_rad_s << ' '
           << cells[i].epsilon_2_percent[0] << ' ' << cells[i].epsilon_2_percent[1] << '\n';
  }
  script << "EOD\nset multiplot layout 2,2 title "
         << Quoted("Contribution of the first two modes, %: " +
                   Caption(surface.theta2_deg, "", options.scaling))
         << "\nset xlabel \"th1', rad/s\"\nset ylabel \"th2', rad/s\"\nset format cb '%.4f'\n"
         << PaletteStyle()
         << "set format z '%.4f'\nset xyplane relative 0\nset xtics 2\nset ytics 3\n";
  const char* map = "unset hidden3d\nset view map\nset colorbox\n";
  const char* above =
      "set hidden3d\nset view 60,30\nunset colorbox\n"
      "set xtics offset 0,-0.4\nset ytics offset 0.8,0\n";
  for (const char* view : {map, above}) {
    const bool is_map = view == map;
    for (const int link : {1, 2}) {
      script << view << "set title 'link " << link << "'\nsplot $data using 1:2:" << link + 2
             << (is_map ? " with pm3d notitle\n"
                        : std::string(" with lines lc rgb '") +
                              Colour(static_cast<std::size_t>(link - 1)) + "' notitle\n");
    }
  }
  DrawPicture(script.str() + "unset multiplot\n", output);
}

}  // namespace

std::vector<std::filesystem::path> DrawReductionFigures(const ArmModel& model,
                                                        const ReductionOptions& options,
                                                        const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const Curve& curve : kCurves) {
    files.push_back(folder / curve.file);
    DrawCurve(model, options, curve, files.back());
  }
  for (const Surface& surface : kSurfaces) {
    files.push_back(folder / surface.file);
    DrawSurface(model, options, surface, files.back());
  }
  return files;
}

void WriteCells(const std::vector<ReductionCell>& cells, const std::filesystem::path& file) {
  std::ostringstream out;
  out << "theta2_deg,theta1_rate_rad_s,theta2_rate_rad_s,link1_epsilon_1_percent,"
         "link1_epsilon_2_percent,link2_epsilon_1_percent,link2_epsilon_2_percent,"
         "rigid_share_percent,negative_roots\n"
      << std::setprecision(10);
  for (const ReductionCell& cell : cells) {
    out << cell.motion.theta2_rad / kRadPerDeg << ',' << cell.motion.theta1_rate_rad_s << ','
        << cell.motion.theta2_rate_rad_s;
    for (std::size_t link = 0; link < 2; ++link) {
      out << ',' << cell.epsilon_1_percent[link] << ',' << cell.epsilon_2_percent[link];
    }
    out << ',' << cell.rigid_share_percent << ',' << cell.negative_roots << '\n';
  }
  WriteFile(file, out.str(), ReplaceAny("a table"));
}

}  // namespace flexarm
