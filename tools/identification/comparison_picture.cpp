#include "tools/identification/comparison_picture.h"

#include <array>
#include <cstdio>
#include <iomanip>
#include <numbers>
#include <sstream>

#include "model/units.h"
#include "tools/plot/gnuplot.h"
#include "tools/plot/picture_style.h"

namespace flexarm {
namespace {

constexpr int kColumnWidth = 800;
constexpr int kRowHeight = 300;

std::string DataName(std::size_t column) { return "$run" + std::to_string(column); }

// Columns: time, then measured and predicted value of every signal, in degrees and millimetres.
void WriteData(std::size_t number, const ComparisonColumn& column, std::ostringstream* script) {
  const RunComparison& run = *column.run;
  *script << DataName(number) << " << EOD\n";
  for (Eigen::Index k = 0; k < run.measured().rows(); ++k) {
    *script << run.time_s()(k);
    for (std::size_t i = 0; i < run.signal().size(); ++i) {
      const auto signal = static_cast<Eigen::Index>(i);
      const double unit = run.signal()[i].angle ? kDegPerRad : 1e3;
      *script << ' ' << unit * run.measured()(k, signal) << ' '
              << unit * column.predicted(k, signal);
    }
    *script << '\n';
  }
  *script << "EOD\n";
}

void DrawSignal(std::size_t number, const ComparisonColumn& column, std::size_t signal,
                double fit_percent, std::ostringstream* script) {
  const ComparedSignal& shown = column.run->signal()[signal];
  std::array<char, 32> fit{};
  std::snprintf(fit.data(), fit.size(), "fit %.1f %%", fit_percent);
  const std::string title =
      (signal == 0 ? column.title + ": " : std::string()) + shown.name + ", " + fit.data();
  *script << "set title " << Quoted(title) << "\nset ylabel '" << (shown.angle ? "deg" : "mm")
          << "'\nplot " << DataName(number) << " using 1:" << 2 + 2 * signal << " with lines "
          << CurveStyle(0) << " title '" << (signal == 0 ? "measured" : "") << "', "
          << DataName(number) << " using 1:" << 3 + 2 * signal << " with lines " << CurveStyle(1)
          << " title '" << (signal == 0 ? "predicted" : "") << "'\n";
}

}  // namespace

void DrawComparison(const std::vector<ComparisonColumn>& column,
                    const std::filesystem::path& output, const OutputRules& rules) {
  const std::size_t rows = column.front().run->signal().size();
  std::ostringstream script;
  script << std::setprecision(8)
         << PictureHead(output, kColumnWidth * static_cast<int>(column.size()),
                        kRowHeight * static_cast<int>(rows));
  for (std::size_t i = 0; i < column.size(); ++i) WriteData(i, column[i], &script);
  script << "set multiplot layout " << rows << ',' << column.size()
         << " columnsfirst\nset autoscale xfix\nset lmargin 10\nset tmargin 2.5\nset key bmargin "
            "right horizontal\n"
            "set xlabel 'time, s'\n";
  for (std::size_t i = 0; i < column.size(); ++i) {
    const Eigen::VectorXd fit = FitPercent(*column[i].run, column[i].predicted);
    for (std::size_t signal = 0; signal < rows; ++signal) {
      DrawSignal(i, column[i], signal, fit(static_cast<Eigen::Index>(signal)), &script);
    }
  }
  script << "unset multiplot\n";
  DrawPicture(script.str(), output, rules);
}

}  // namespace flexarm
