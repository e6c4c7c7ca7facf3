#include "tools/report/loop_picture.h"

#include <array>
#include <iomanip>
#include <sstream>

#include "tools/plot/gnuplot.h"
#include "tools/plot/picture_style.h"

namespace flexarm {
namespace {

// Columns of the data block: time, then two columns per quantity.
constexpr int kBending = 2, kAngle = 4, kReference = 6, kTorque = 8;

struct Panel {
  int column;
  std::array<const char*, 2> label;  ///< of link or joint 1 and 2
};

Panel PanelOf(LoopView view) {
  switch (view) {
    case LoopView::kBending:
      return {kBending, {"link 1, mm", "link 2, mm"}};
    case LoopView::kTrajectory:
      return {kAngle, {"joint 1, deg", "joint 2, deg"}};
    case LoopView::kEffort:
      break;
  }
  return {kTorque, {"motor 1, N m", "motor 2, N m"}};
}

void WriteData(const PlotRun& run, std::size_t number, std::ostringstream* script) {
  *script << "$run" << number << " << EOD\n";
  for (const PlotRun::Sample& s : run.sample) {
    if (s.time_s < 0.0 || s.time_s > run.act.back().until_s) continue;
    *script << s.time_s;
    for (const auto& pair : {s.deflection_mm, s.angle_deg, s.reference_deg, s.applied_nm}) {
      *script << ' ' << pair[0] << ' ' << pair[1];
    }
    *script << '\n';
  }
  *script << "EOD\n";
}

void WritePanel(LoopView view, int which, const std::vector<PlotRun>& runs,
                std::ostringstream* script) {
  const Panel panel = PanelOf(view);
  *script << "set ylabel " << Quoted(panel.label[static_cast<std::size_t>(which)]) << '\n'
          << (which == 0 ? "set key at screen 0.75, screen 0.95 top left vertical Left reverse\n"
                         : "unset key\n")
          << "plot ";
  const char* style = view == LoopView::kEffort ? "steps" : "lines";
  for (std::size_t i = 0; i < runs.size(); ++i) {
    *script << (i > 0 ? ", " : "") << "$run" << i << " using 1:" << panel.column + which << " with "
            << style << ' ' << CurveStyle(i, 1.7) << " title " << Quoted(runs[i].name);
  }
  if (view == LoopView::kTrajectory) {
    *script << ", $run0 using 1:" << kReference + which << " with lines " << ReferenceStyle()
            << " title 'reference'";
  }
  *script << '\n';
}

}  // namespace

const char* TitleOf(LoopView view) {
  switch (view) {
    case LoopView::kBending:
      return "Bending motion";
    case LoopView::kTrajectory:
      return "Joint trajectory";
    case LoopView::kEffort:
      break;
  }
  return "Control effort";
}

void DrawLoopRuns(const std::vector<PlotRun>& runs, LoopView view,
                  const std::filesystem::path& output) {
  std::ostringstream script;
  script << PictureHead(output, 1000, 560) << std::setprecision(7);
  for (std::size_t i = 0; i < runs.size(); ++i) WriteData(runs[i], i, &script);
  script << "set multiplot layout 2,1 title " << Quoted(TitleOf(view))
         << "\nset lmargin at screen 0.08\nset rmargin at screen 0.74\n"
            "set xlabel 'time, s'\nset xrange [0:6]\n";
  for (const int which : {0, 1}) WritePanel(view, which, runs, &script);
  script << "unset multiplot\n";
  DrawPicture(script.str(), output);
}

}  // namespace flexarm
