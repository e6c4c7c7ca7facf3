#include "tools/plot/plot_script.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "tools/plot/arm_views.h"
#include "tools/plot/gnuplot.h"
#include "tools/plot/picture_style.h"
#include "tools/plot/plot_rows.h"
#include "tools/plot/sheet.h"
#include "tools/plot/time_axis.h"

namespace flexarm {
namespace {

constexpr std::size_t kMostRows = 4000;  // about five a pixel
constexpr double kLeft = 0.062, kRight = 0.575;

// A panel of the left column.
struct Panel {
  std::string title;
  ValueRange range;
  std::vector<std::string> curves;
  double limit = 0.0;  // drawn at +-limit where the range has them; 0: none
  bool logarithmic = false;
};

class Script {
 public:
  Script(const std::vector<PlotRun>& runs, const std::filesystem::path& output) : runs_(runs) {
    for (const PlotRun& run : runs) rows_.push_back(PlotRows(run, kMostRows));
    for (const int joint : {0, 1}) AddAngle(joint);
    for (const int joint : {0, 1}) AddTorque(joint);
    AddStrain();
    AddDeflections();
    AddDistance();
    AddPayload();
    const int rows = static_cast<int>(runs.size());
    sheet_.height =
        kHeader + 20 * rows + kPanel * static_cast<int>(panels_.size()) + 22 * rows + 90;
    sheet_.height = std::max(sheet_.height, kLeastHeight);
    text_ << PictureHead(output, sheet_.width, sheet_.height) << std::setprecision(7);
    for (std::size_t i = 0; i < runs.size(); ++i) WriteData(i);
  }

  std::string Text() {
    text_ << "set multiplot\n";
    const TimeAxis axis(runs_);
    axis.WriteMarks(&text_);
    WriteHeader();
    double top = kHeader + 20.0 * static_cast<double>(runs_.size());
    for (const Panel& panel : panels_) {
      WritePanel(panel, axis, top);
      top += kPanel;
    }
    axis.WriteStates(sheet_, {kLeft, kRight}, top, &text_);
    WriteArmViews(runs_, axis, sheet_, kHeader + 20.0 * static_cast<double>(runs_.size()), &text_);
    text_ << "unset multiplot\n";
    return text_.str();
  }

 private:
  static constexpr int kHeader = 78, kPanel = 142, kPanelBody = 104, kLeastHeight = 1100;

  bool alone() const { return runs_.size() == 1; }

  void WriteData(std::size_t run) {
    text_ << "$run" << run << " << EOD\n";
    for (const PlotRow& row : rows_[run]) {
      if (std::isnan(row[kAngleColumn])) {
        text_ << '\n';  // which ends every curve
        continue;
      }
      for (const double value : row) text_ << value << ' ';
      text_ << '\n';
    }
    text_ << "EOD\n";
  }

  ValueRange Range(std::size_t column, std::size_t columns = 1) const {
    ValueRange range = RangeOf(rows_[0], column, columns);
    for (const auto& rows : rows_) {
      const ValueRange more = RangeOf(rows, column, columns);
      range = {std::min(range.low, more.low), std::max(range.high, more.high)};
    }
    return range;
  }

  // A curve of a run; NaN is written as a missing value, which gnuplot leaves out.
  static std::string Curve(std::size_t run, std::size_t column, const std::string& with,
                           const std::string& title, double later_s = 0.0) {
    std::ostringstream curve;
    curve << "$run" << run << " using ($1+" << later_s << "):" << column + 1 << " with " << with
          << (title.empty() ? " notitle" : " title " + Quoted(title));
    return curve.str();
  }

  void Add(Panel panel) {
    if (!panel.range.empty()) panels_.push_back(std::move(panel));
  }

  void AddAngle(int joint) {
    const auto j = static_cast<std::size_t>(joint);
    Panel panel{.title = "Joint " + std::to_string(joint + 1) + ", deg",
                .range = Range(kAngleColumn + j),
                .curves = {}};
    const char* name = runs_[0].truth ? "true" : "estimated";
    for (std::size_t run = 0; run < runs_.size(); ++run) {
      panel.curves.push_back(Curve(run, kAngleColumn + j,
                                   "lines " + CurveStyle(run, alone() ? 2.6 : 2.0),
                                   alone() ? name : ""));
    }
    const ValueRange reference = RangeOf(rows_[0], kReferenceColumn + j);
    if (!reference.empty()) {
      panel.range = {std::min(panel.range.low, reference.low),
                     std::max(panel.range.high, reference.high)};
      panel.curves.push_back(Curve(0, kReferenceColumn + j, "lines " + ReferenceStyle(),
                                   alone() ? "reference" : "reference of run 1"));
    }
    Add(panel);
  }

  void AddTorque(int joint) {
    const auto j = static_cast<std::size_t>(joint);
    Panel panel{.title = "Torque " + std::to_string(joint + 1) + ", N m",
                .range = Range(kAppliedColumn + j),
                .curves = {},
                .limit = runs_[0].torque_limit_nm[j]};
    for (std::size_t run = 0; run < runs_.size(); ++run) {
      panel.curves.push_back(Curve(run, kAppliedColumn + j,
                                   "fsteps " + CurveStyle(run, alone() ? 2.6 : 1.6),
                                   alone() ? "applied" : ""));
    }
    if (alone()) {
      // A torque asked at a tick acts from the next one on; the applied one acted up to its tick.
      panel.curves.push_back(
          Curve(0, kAskedColumn + j, "steps " + ReferenceStyle(), "asked", runs_[0].period_s));
      if (!RangeOf(rows_[0], kGatedColumn + j).empty()) {
        panel.curves.push_back(
            Curve(0, kGatedColumn + j,
                  std::string("points pt 6 ps 0.7 lw 1.5 lc rgb '") + kLimitColour + "'", "gated"));
      }
    }
    Add(panel);
  }

  // One panel of both links for one run; one a link for several.
  void AddPairs(const std::string& title, std::size_t column, double limit) {
    for (std::size_t link = 0; link < (alone() ? 1U : 2U); ++link) {
      Panel panel{.title = alone() ? title : title + ", link " + std::to_string(link + 1),
                  .range = Range(column + link, alone() ? 2 : 1),
                  .curves = {},
                  .limit = limit};
      for (std::size_t run = 0; run < runs_.size(); ++run) {
        panel.curves.push_back(
            Curve(run, column + link, "lines " + CurveStyle(run), alone() ? "link 1" : ""));
      }
      if (alone()) {
        panel.curves.push_back(Curve(0, column + 1, "lines " + CurveStyle(1), "link 2"));
      }
      Add(panel);
    }
  }

  void AddStrain() {
    const auto& limit = runs_[0].strain_limit;
    std::ostringstream title;
    title << "Root strain, % of " << std::round(1e6 * limit[0]);
    if (limit[0] != limit[1]) title << " and " << std::round(1e6 * limit[1]);
    AddPairs(alone() ? title.str() + " microstrain" : "Root strain, % of its limit", kStrainColumn,
             100.0);
  }

  void AddDeflections() { AddPairs("Tip deflection, mm", kDeflectionColumn, 0.0); }

  void AddDistance() {
    if (Range(kTargetColumn).empty()) return;
    Panel panel{.title = "Tip to its target, mm",
                .range = {0.3, 3000.0},
                .curves = {},
                .limit = 0.0,
                .logarithmic = true};
    std::ostringstream settled;
    const double settled_mm = std::round(10.0 * runs_[0].settled_within_mm) / 10.0;
    settled << settled_mm << " with lines " << ReferenceStyle() << " title '" << settled_mm
            << " mm: settled'";
    for (std::size_t run = 0; run < runs_.size(); ++run) {
      panel.curves.push_back(Curve(run, kTargetColumn, "lines " + CurveStyle(run), ""));
    }
    panel.curves.push_back(settled.str());
    Add(panel);
  }

  void AddPayload() {
    Panel panel{.title = "Payload estimate, kg", .range = Range(kPayloadColumn), .curves = {}};
    const double margin = 0.05;
    panel.range.low = std::min(panel.range.low, 0.0);
    panel.range.high += panel.range.empty() ? 0.0 : margin;
    for (std::size_t run = 0; run < runs_.size(); ++run) {
      if (RangeOf(rows_[run], kPayloadColumn).empty()) continue;
      std::ostringstream band;
      band << "$run" << run << " using 1:($" << kPayloadColumn + 1 << "-$" << kSigmaColumn + 1
           << "):($" << kPayloadColumn + 1 << "+$" << kSigmaColumn + 1
           << ") with filledcurves fs transparent solid 0.25 lc rgb '" << Colour(run) << "'"
           << (alone() ? " title '+- sigma'" : " notitle");
      panel.curves.push_back(band.str());
      panel.curves.push_back(
          Curve(run, kPayloadColumn, "lines " + CurveStyle(run), alone() ? "estimate" : ""));
    }
    if (!panel.curves.empty()) Add(panel);
  }

  void WriteHeader() {
    const std::string title =
        alone() ? runs_[0].title : std::to_string(runs_.size()) + " runs in the same axes";
    text_ << "set label 1 " << Quoted(title) << " at screen " << 0.02 << ", screen " << sheet_.Y(30)
          << " left font ',17' textcolor rgb '" << kInkColour << "'\n";
    for (std::size_t run = 0; run < runs_.size(); ++run) {
      const PlotRun& of = runs_[run];
      const double y = sheet_.Y(56.0 + 20.0 * static_cast<double>(run));
      std::string line =
          alone() ? of.details : std::to_string(run + 1) + "  " + of.title + "; " + of.details;
      if (!of.trip.empty()) line += "   TRIPPED: " + of.trip;
      text_ << "set label " << 2 + run << ' ' << Quoted(line) << " at screen "
            << (alone() ? 0.02 : 0.065) << ", screen " << y << " left font ',12' textcolor rgb '"
            << (of.trip.empty() ? kMutedColour : kLimitColour) << "'\n";
      if (alone()) continue;
      text_ << "set arrow " << 1 + run << " from screen 0.02, screen " << y << " to screen 0.058, "
            << "screen " << y << " nohead " << CurveStyle(run, 2.6) << '\n';
    }
  }

  void WritePanel(const Panel& panel, const TimeAxis& axis, double top) {
    text_ << "set lmargin at screen " << kLeft << "\nset rmargin at screen " << kRight
          << "\nset tmargin at screen " << sheet_.Y(top + kPanel - kPanelBody)
          << "\nset bmargin at screen " << sheet_.Y(top + kPanel) << '\n';
    axis.WriteRange(false, &text_);
    std::string title = panel.title;
    ValueRange range = panel.range;
    std::vector<std::string> curves = panel.curves;
    if (panel.logarithmic) {
      text_ << "set logscale y\nset ytics (1,10,100,1000)\n";
    } else {
      const double largest = std::max(std::abs(range.low), std::abs(range.high));
      if (panel.limit > 0.0 && largest > 0.5 * panel.limit) {
        range = {std::min(range.low, -1.05 * panel.limit),
                 std::max(range.high, 1.05 * panel.limit)};
        for (const double limit : {panel.limit, -panel.limit}) {
          std::ostringstream line;
          line << limit << " with lines " << LimitStyle()
               << (limit > 0.0 ? " title 'limit'" : " notitle");
          curves.push_back(line.str());
        }
      } else if (panel.limit > 0.0) {
        std::ostringstream beyond;
        beyond << "; limit " << panel.limit;
        title += beyond.str();
      }
      const double margin = std::max(0.06 * (range.high - range.low), 1e-3);
      range = {range.low - margin, range.high + margin};
      text_ << "unset logscale y\nset ytics " << NiceStep(range.high - range.low, 6) << '\n';
    }
    text_ << "set yrange [" << range.low << ':' << range.high << "]\nset label 900 "
          << Quoted(title) << " at graph 0, graph 1 offset 0,0.75 left font ',12' textcolor rgb '"
          << kInkColour
          << "'\nset key bottom right at graph 1.01, graph 1.02 horizontal maxrows 1\nplot ";
    for (std::size_t i = 0; i < curves.size(); ++i) {
      text_ << (i > 0 ? ", \\\n  " : "") << curves[i];
    }
    text_ << '\n';
    ClearHeader();
  }

  // gnuplot draws labels with every plot of a sheet: the header's belong to the first.
  void ClearHeader() {
    for (std::size_t i = 0; i <= runs_.size(); ++i) text_ << "unset label " << i + 1 << '\n';
    if (!alone()) {
      for (std::size_t i = 0; i < runs_.size(); ++i) text_ << "unset arrow " << i + 1 << '\n';
    }
  }

  const std::vector<PlotRun>& runs_;
  std::vector<std::vector<PlotRow>> rows_;
  std::vector<Panel> panels_;
  Sheet sheet_;
  std::ostringstream text_;
};

}  // namespace

std::string PlotScript(const std::vector<PlotRun>& runs, const std::filesystem::path& output) {
  return Script(runs, output).Text();
}

}  // namespace flexarm
