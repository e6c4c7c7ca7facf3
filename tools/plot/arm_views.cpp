#include "tools/plot/arm_views.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tools/plot/gnuplot.h"
#include "tools/plot/picture_style.h"
#include "tools/plot/plot_rows.h"
#include "tools/plot/run_marks.h"

namespace flexarm {
namespace {

constexpr double kLeft_px = 890.0, kRight_px = 1375.0, kGap_px = 55.0, kTitle_px = 26.0;
constexpr std::size_t kMostFigures = 4;  // runs

struct Reach {
  std::array<double, 2> low{-0.05, -0.05}, high{0.05, 0.05};

  void Add(const std::array<double, 2>& point) {
    for (std::size_t axis = 0; axis < 2; ++axis) {
      low[axis] = std::min(low[axis], point[axis]);
      high[axis] = std::max(high[axis], point[axis]);
    }
  }
  double size(std::size_t axis) const { return high[axis] - low[axis]; }
};

Reach ReachOf(const std::vector<PlotRun>& runs) {
  Reach reach;
  for (const PlotRun& run : runs) {
    for (const PlotRun::View& view : run.view) {
      for (const PlotRun::Pose& pose : view.pose) {
        for (const auto& point : pose.point_m) reach.Add(point);
      }
      for (const auto& point : view.path) reach.Add(point);
    }
  }
  const double margin = 0.05 * std::max(reach.size(0), reach.size(1));
  for (std::size_t axis = 0; axis < 2; ++axis) {
    reach.low[axis] -= margin;
    reach.high[axis] += margin;
  }
  return reach;
}

// The largest views that a number of columns leaves room for.
struct Grid {
  std::size_t columns = 1, rows = 1;
  double width = 0.0, height = 0.0;  // of a view, px

  Grid() = default;
  Grid(std::size_t count, std::size_t of_columns, double aspect, double most_px)
      : columns(of_columns), rows((count + of_columns - 1) / of_columns) {
    const auto c = static_cast<double>(columns), r = static_cast<double>(rows);
    const double widest = (kRight_px - kLeft_px - kGap_px * (c - 1.0)) / c;
    height = std::min(widest * aspect, most_px / r - kTitle_px - kGap_px);
    width = height / aspect;
  }
};

class Views {
 public:
  Views(const std::vector<PlotRun>& runs, const TimeAxis& axis, const Sheet& sheet, double top_px,
        std::ostringstream* script)
      : runs_(runs), axis_(axis), sheet_(sheet), top_px_(top_px), script_(*script) {}

  void Write() {
    const Reach reach = ReachOf(runs_);
    const std::size_t count = runs_[0].view.size();
    const double aspect = reach.size(1) / reach.size(0);
    const double most_px = sheet_.height - top_px_ - 20.0 * TextLines() - 50.0;
    Grid grid;
    for (const std::size_t columns : {1U, 2U, 3U}) {
      const Grid other(count, columns, aspect, most_px);
      if (other.width > grid.width * 1.05) grid = other;
    }
    const auto [columns, rows, width, height] = grid;
    script_ << "set format x '%g'\nset xlabel 'x, m' offset 0,0.5\nset xrange [" << reach.low[0]
            << ':' << reach.high[0] << "]\nset yrange [" << reach.low[1] << ':' << reach.high[1]
            << "]\nset xtics " << NiceStep(reach.size(0), width > 300 ? 8 : 4) << "\nset ytics "
            << NiceStep(reach.size(1), height > 250 ? 8 : 4) << '\n'
            << PaletteStyle() << "unset colorbox\n";
    WriteData();
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t row = i / columns, column = i % columns;
      const double left = kLeft_px + static_cast<double>(column) * (width + kGap_px);
      const double top =
          top_px_ + kTitle_px + static_cast<double>(row) * (height + kTitle_px + kGap_px);
      script_ << "set ylabel '" << (column == 0 ? "y, m" : "") << "' offset 0.8,0\n";
      WriteView(i, left, top, width, height);
    }
    WriteText(top_px_ + static_cast<double>(rows) * (height + kTitle_px + kGap_px) + 14.0);
  }

 private:
  void WriteData() {
    script_ << "$base << EOD\n0 0\nEOD\n";
    for (std::size_t run = 0; run < runs_.size(); ++run) {
      for (std::size_t i = 0; i < runs_[run].view.size(); ++i) {
        const PlotRun::View& view = runs_[run].view[i];
        script_ << "$pose" << run << '_' << i << " << EOD\n";
        for (const PlotRun::Pose& pose : view.pose) {
          const double share =
              (pose.time_s - view.from_s) / std::max(view.until_s - view.from_s, 1e-9);
          for (const auto& point : pose.point_m) {
            script_ << point[0] << ' ' << point[1] << ' ' << share << '\n';
          }
          script_ << "\n\n";
        }
        script_ << "EOD\n$path" << run << '_' << i << " << EOD\n";
        for (const auto& point : view.path) script_ << point[0] << ' ' << point[1] << '\n';
        script_ << "EOD\n";
      }
    }
  }

  void WriteView(std::size_t i, double left, double top, double width, double height) {
    const PlotRun::View& view = runs_[0].view[i];
    std::ostringstream title;
    title << "move " << view.number << ": " << std::round(100.0 * view.from_s) / 100.0 << " to "
          << std::round(100.0 * view.until_s) / 100.0 << " s";
    script_ << "set lmargin at screen " << sheet_.X(left) << "\nset rmargin at screen "
            << sheet_.X(left + width) << "\nset tmargin at screen " << sheet_.Y(top)
            << "\nset bmargin at screen " << sheet_.Y(top + height) << "\nset label 3 "
            << Quoted(title.str())
            << " at graph 0, graph 1 offset 0,0.75 left font ',12' textcolor rgb '" << kInkColour
            << "'\nplot ";
    for (std::size_t run = 0; run < runs_.size(); ++run) {
      if (i >= runs_[run].view.size()) continue;
      if (!runs_[run].view[i].pose.empty()) WritePoses(run, i);
      if (!runs_[run].view[i].path.empty()) {
        script_ << "$path" << run << '_' << i << " with lines "
                << (runs_.size() == 1 ? std::string("lw 1.3 dt 1 lc rgb '") + kInkColour + "'"
                                      : CurveStyle(run))
                << ", \\\n  ";
      }
    }
    script_ << "$base with points pt 7 ps 1.5 lc rgb '#404040'\n";
  }

  // All poses of one run, dark to light; of several runs only the last of each.
  void WritePoses(std::size_t run, std::size_t i) {
    script_ << "$pose" << run << '_' << i;
    if (runs_.size() == 1) {
      script_ << " using 1:2:3 with lines lw 1.7 lc palette, \\\n  ";
    } else {
      script_ << " index " << runs_[run].view[i].pose.size() - 1 << " with lines "
              << CurveStyle(run, 2.6) << ", \\\n  ";
    }
  }

  struct Line {
    std::string text;
    bool heading;
  };

  std::vector<Line> Text() const {
    const PlotRun& first = runs_[0];
    std::vector<Line> lines;
    lines.push_back(
        {runs_.size() > 1 ? "Lines: paths of the tip; thick: each arm at the end of the move"
         : first.view.size() < first.act.size()
             ? std::to_string(first.view.size()) + " of " + std::to_string(first.act.size()) +
                   " moves, evenly chosen; time from dark to light"
             : "Arms: time from dark to light; line: path of the tip",
         false});
    for (std::size_t run = 0; run < std::min(runs_.size(), kMostFigures); ++run) {
      if (!runs_[run].metrics) continue;
      lines.push_back({runs_.size() == 1 ? "Figures" : "Run " + std::to_string(run + 1), true});
      for (const std::string& text : FigureLines(*runs_[run].metrics))
        lines.push_back({text, false});
    }
    const std::vector<std::string> marks = axis_.Lines();
    if (!marks.empty()) lines.push_back({"Events", true});
    for (const std::string& text : marks) lines.push_back({text, false});
    return lines;
  }

  double TextLines() const {
    double lines = 0.0;
    for (const Line& line : Text()) lines += line.heading ? 1.5 : 1.0;
    return lines;
  }

  // The text below the views. gnuplot draws labels only with a plot: this one is empty.
  void WriteText(double y_px) {
    int label = 3;
    for (const Line& line : Text()) {
      y_px += line.heading ? 10.0 : 0.0;
      script_ << "set label " << label++ << ' ' << Quoted(line.text) << " at screen "
              << sheet_.X(kLeft_px - 40.0) << ", screen " << sheet_.Y(y_px) << " left font '"
              << (line.heading ? ",13" : ",11") << "' textcolor rgb '" << kInkColour << "' front\n";
      y_px += 20.0;
    }
    script_ << "unset border\nunset tics\nunset xlabel\nunset ylabel\nset xrange [0:1]\nset yrange "
               "[0:1]\nplot -1 with lines notitle\n";
  }

  const std::vector<PlotRun>& runs_;
  const TimeAxis& axis_;
  const Sheet& sheet_;
  double top_px_;
  std::ostringstream& script_;
};

}  // namespace

void WriteArmViews(const std::vector<PlotRun>& runs, const TimeAxis& axis, const Sheet& sheet,
                   double top_px, std::ostringstream* script) {
  Views(runs, axis, sheet, top_px, script).Write();
}

}  // namespace flexarm
