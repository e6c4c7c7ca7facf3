#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "config/config_reference.h"
#include "config/key_survey.h"
#include "config/key_units.h"
#include "controller/runlog/errors.h"
#include "tools/plot/gnuplot.h"
#include "tools/plot/picture_style.h"
#include "tools/sweep/sweep_summary.h"

namespace flexarm {
namespace {

// A measure with a panel of its own, and the label of its axis.
struct Panel {
  std::size_t measure;
  const char* label;
};
constexpr std::array<Panel, 8> kPanels = {{{0, "rms error, joint 1, deg"},
                                           {1, "rms error, joint 2, deg"},
                                           {2, "final error, joint 1, deg"},
                                           {3, "final error, joint 2, deg"},
                                           {kSettling, "settling of the tip, s"},
                                           {kTargetError, "tip off its target, mm"},
                                           {kResidual, "residual at the tip, mm"},
                                           {kMotion, "motion after 0.3 s, mm rms"}}};
constexpr double kShift = 0.012;  // of a curve beside the one before it, as a share of the axis

bool IsNumber(const std::string& text) {
  double value = 0.0;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && rest == end;
}

struct Curve {
  std::string title;
  std::vector<const SweepGroup*> groups;
};

// The unit of its values; "" of words and of numbers without one.
std::string UnitOf(const SweepAxis& axis) {
  const bool is_key = axis.target == AxisTarget::kConfig || axis.target == AxisTarget::kPlant;
  if (!is_key) return UnitOfName(axis.Column());
  const std::string path = KeySurvey::Pattern(axis.key);
  for (const ListedKey& key : RigReference().keys) {
    if (key.path == path || key.path + "[]" == path) return key.unit == "1" ? "" : key.unit;
  }
  return "";
}

std::string LabelOf(const SweepAxis& axis) {
  const std::string unit = UnitOf(axis);
  return axis.Column() + (unit.empty() ? "" : ", " + unit);
}

std::vector<Curve> CurvesOf(const SweepSummary& summary) {
  std::vector<Curve> curves;
  for (const SweepGroup& group : summary.groups) {
    std::string title;
    for (std::size_t i = 0; i + 1 < summary.axes.size(); ++i) {
      if (summary.axes[i].values.size() == 1) continue;
      const std::string unit = UnitOf(summary.axes[i]);
      title += (title.empty() ? "" : ", ") + summary.axes[i].Column() + " " +
               summary.axes[i].values[group.index[i]] + (unit.empty() ? "" : " " + unit);
    }
    if (curves.empty() || curves.back().title != title) curves.push_back({title, {}});
    curves.back().groups.push_back(&group);
  }
  return curves;
}

// Where the values of an axis lie: numbers at their place, words one after the other.
struct Axis {
  const SweepAxis* of;
  bool numbers;

  double At(std::size_t i) const {
    return numbers ? std::stod(of->values[i]) : static_cast<double>(i);
  }
  double low() const {
    double least = At(0);
    for (std::size_t i = 0; i < of->values.size(); ++i) least = std::min(least, At(i));
    return least;
  }
  double high() const {
    double most = At(0);
    for (std::size_t i = 0; i < of->values.size(); ++i) most = std::max(most, At(i));
    return most;
  }
  double width() const { return std::max(high() - low(), 1e-9); }
};

// Rows of place, median, least, greatest; then those without a median, at the top of the panel.
std::string DataOf(const Curve& curve, std::size_t measure, const Axis& axis, double shift,
                   bool missing) {
  std::ostringstream data;
  for (const SweepGroup* group : curve.groups) {
    const double at = axis.At(group->index.back()) + shift;
    const double median = group->median[measure], most = group->most[measure];
    if (std::isfinite(median) == missing) continue;
    data << at;
    if (!missing) {
      data << ' ' << median << ' ' << group->least[measure] << ' '
           << (std::isfinite(most) ? most : median);
    }
    data << '\n';
  }
  return data.str();
}

std::string PanelScript(const Panel& panel, const std::vector<Curve>& curves, const Axis& axis) {
  std::ostringstream script, plots;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const double shift = kShift * axis.width() * static_cast<double>(i);
    const std::string values = DataOf(curves[i], panel.measure, axis, shift, false);
    const std::string missing = DataOf(curves[i], panel.measure, axis, shift, true);
    if (!values.empty()) {
      script << "$values" << i << " << EOD\n" << values << "EOD\n";
      plots << (plots.str().empty() ? "" : ", ") << "$values" << i << " using 1:2:3:4 with "
            << (axis.numbers ? "yerrorlines" : "yerrorbars") << " pt 7 ps 0.8 " << CurveStyle(i)
            << ' ' << (curves[i].title.empty() ? "notitle" : "title " + Quoted(curves[i].title));
    }
    if (!missing.empty()) {
      script << "$missing" << i << " << EOD\n" << missing << "EOD\n";
      plots << (plots.str().empty() ? "" : ", ") << "$missing" << i
            << " using 1:(1) axes x1y2 with points pt 2 ps 1.4 lw 2 lc rgb '" << Colour(i)
            << "' notitle";
    }
  }
  script << "set ylabel " << Quoted(panel.label) << "\nplot " << plots.str() << '\n';
  return script.str();
}

}  // namespace

void DrawSummary(const SweepSummary& summary, const std::filesystem::path& output,
                 const OutputRules& rules) {
  if (summary.axes.empty() || summary.groups.empty()) {
    throw InputError(
        output.string() +
        ": there is nothing to draw: the sweep has no axis other than its seeds, or no run yet");
  }
  const SweepAxis& last = summary.axes.back();
  const Axis axis{&last, std::all_of(last.values.begin(), last.values.end(), IsNumber)};
  const std::vector<Curve> curves = CurvesOf(summary);
  const double margin = (axis.numbers ? 0.03 : 0.5) * axis.width() /
                        (axis.numbers ? 1.0 : std::max(axis.width(), 1.0));
  std::ostringstream head;
  head << PictureHead(output, 1300, 1500) << "set multiplot layout 4,2 title "
       << Quoted("Sweep of " + last.Column() +
                 ": medians over the completed runs, bars from the "
                 "least to the greatest; cross: none completed, or not settled")
       << "\nset yrange [0:*]\nset y2range [0:1.06]\nset tmargin 3\nset xlabel "
       << Quoted(LabelOf(last)) << "\nset xrange [" << axis.low() - margin << ':'
       << axis.high() + margin + kShift * axis.width() * static_cast<double>(curves.size())
       << "]\n";
  std::string script = head.str();
  if (!axis.numbers) {
    script += "set xtics rotate by -30 (";
    for (std::size_t i = 0; i < last.values.size(); ++i) {
      script += (i == 0 ? "" : ", ") + Quoted(last.values[i]) + " " + std::to_string(i);
    }
    script += ")\n";
  }
  for (const Panel& panel : kPanels) script += PanelScript(panel, curves, axis);
  DrawPicture(script + "unset multiplot\n", output, rules);
}

}  // namespace flexarm
