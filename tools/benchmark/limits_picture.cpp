#include "tools/benchmark/limits_picture.h"

#include <array>
#include <cmath>
#include <sstream>

#include "tools/plot/gnuplot.h"
#include "tools/plot/picture_style.h"

namespace flexarm {
namespace {

// Columns of the data block: number of the scenario, then mean and largest of each figure.
struct Panel {
  int mean_column;
  const char* label;
};
constexpr std::array<Panel, 2> kPanels = {
    {{2, "residual of the last 0.3 s, mm"}, {4, "motion from 0.3 s after the move, mm"}}};

std::string Cell(double value) { return std::isfinite(value) ? std::to_string(value) : "NaN"; }

void WriteData(const std::vector<BenchmarkCell>& cells, std::size_t law, std::ostream* script) {
  *script << "$law" << law << " << EOD\n";
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const RestFigures& r = cells[i].rests;
    *script << i << ' ' << Cell(r.residual_mean_mm) << ' ' << Cell(r.residual_max_mm) << ' '
            << Cell(r.motion_mean_mm) << ' ' << Cell(r.motion_max_mm) << '\n';
  }
  *script << "EOD\n";
}

void WritePanel(const Panel& panel, const std::vector<std::string>& laws, std::ostream* script) {
  const double width = 0.8 / static_cast<double>(laws.size());
  *script << "set ylabel " << Quoted(panel.label) << "\nset boxwidth " << width << "\nplot ";
  for (std::size_t i = 0; i < laws.size(); ++i) {
    const double at = (static_cast<double>(i) + 0.5) * width - 0.4;
    const std::string data = "$law" + std::to_string(i) + " using ($1+" + std::to_string(at) + "):";
    const std::string mean = std::to_string(panel.mean_column);
    *script << (i > 0 ? ", " : "") << data << mean << " with boxes fs solid 0.7 lc rgb '"
            << Colour(i) << "' title " << Quoted(laws[i]) << ", " << data << mean << ":(0):($"
            << panel.mean_column + 1 << "-$" << mean
            << ") with vectors head filled size 0.06,60 lw "
            << "1.5 lc rgb '" << kInkColour << "' notitle";
  }
  *script << '\n';
}

}  // namespace

void DrawLimits(const BenchmarkTable& table, const std::filesystem::path& output) {
  std::ostringstream script;
  script << PictureHead(output, 1200, 900);
  for (std::size_t law = 0; law < table.laws.size(); ++law) {
    WriteData(table.cell[law], law, &script);
  }
  script << "set multiplot layout 2,1 title 'Mean over the runs (boxes) and the largest (arrows)'\n"
            "set offsets 0, 0, graph 0.08, 0\nset yrange [0:*]\n"
         << "set xrange [-0.6:" << static_cast<double>(table.scenarios.size()) - 0.4
         << "]\nset xtics rotate by -20 (";
  for (std::size_t i = 0; i < table.scenarios.size(); ++i) {
    script << (i > 0 ? ", " : "") << Quoted(table.scenarios[i].name) << ' ' << i;
  }
  script << ")\n";
  for (const Panel& panel : kPanels) WritePanel(panel, table.laws, &script);
  script << "unset multiplot\n";
  DrawPicture(script.str(), output);
}

}  // namespace flexarm
