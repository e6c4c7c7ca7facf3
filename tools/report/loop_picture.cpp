#include "tools/report/loop_picture.h"

#include <array>
#include <iomanip>
#include <sstream>

#include "tools/plot/gnuplot.h"

namespace flexarm {
namespace {

constexpr std::size_t kReferenceColour = 7;

// Columns of the data block: time, then two columns per quantity.
constexpr int kBending = 2, kAngle = 4, kReference = 6, kTorque = 8;

struct Panel {
  int column;
  const char* label;
};
constexpr std::array<Panel, 6> kPanels = {{{kBending, "bending of link 1, mm"},
                                           {kBending + 1, "bending of link 2, mm"},
                                           {kAngle, "joint 1, deg"},
                                           {kAngle + 1, "joint 2, deg"},
                                           {kTorque, "torque 1, N m"},
                                           {kTorque + 1, "torque 2, N m"}}};

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

void WritePanel(const Panel& panel, const std::vector<PlotRun>& runs, bool first,
                std::ostringstream* script) {
  *script << "set ylabel " << Quoted(panel.label) << '\n'
          << (first ? "set key top right\n" : "unset key\n") << "plot ";
  if (panel.column == kAngle || panel.column == kAngle + 1) {
    *script << "$run0 using 1:" << panel.column + kReference - kAngle
            << " with lines lw 2 dt 2 lc rgb '" << Colour(kReferenceColour) << "' notitle, ";
  }
  const char* style = panel.column >= kTorque ? "steps" : "lines";
  for (std::size_t i = 0; i < runs.size(); ++i) {
    *script << (i > 0 ? ", " : "") << "$run" << i << " using 1:" << panel.column << " with "
            << style << " lw 1.5 lc rgb '" << Colour(i) << "' title " << Quoted(runs[i].name);
  }
  *script << '\n';
}

}  // namespace

void DrawLoopRuns(const std::vector<PlotRun>& runs, const std::string& title,
                  const std::filesystem::path& output) {
  std::ostringstream script;
  script << TerminalFor(output, 1200, 1000) << std::setprecision(7);
  for (std::size_t i = 0; i < runs.size(); ++i) WriteData(runs[i], i, &script);
  script << "set multiplot layout 3,2 title " << Quoted(title)
         << "\nset grid lc rgb '#D9D9D9'\nset xlabel 's'\n";
  for (std::size_t i = 0; i < kPanels.size(); ++i) WritePanel(kPanels[i], runs, i == 0, &script);
  script << "unset multiplot\n";
  DrawPicture(script.str(), output);
}

}  // namespace flexarm
