#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <vector>

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
constexpr std::array<Panel, 6> kPanels = {{{0, "rms error, joint 1, deg"},
                                           {1, "rms error, joint 2, deg"},
                                           {2, "final error, joint 1, deg"},
                                           {3, "final error, joint 2, deg"},
                                           {4, "settling of the tip, s"},
                                           {5, "residual at the tip, mm"}}};

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

std::vector<Curve> CurvesOf(const SweepSummary& summary) {
  std::vector<Curve> curves;
  for (const SweepGroup& group : summary.groups) {
    std::string title;
    for (std::size_t i = 0; i + 1 < summary.axes.size(); ++i) {
      if (summary.axes[i].values.size() == 1) continue;
      title += (title.empty() ? "" : ", ") + summary.axes[i].Column() + " " +
               summary.axes[i].values[group.index[i]];
    }
    if (curves.empty() || curves.back().title != title) curves.push_back({title, {}});
    curves.back().groups.push_back(&group);
  }
  return curves;
}

std::string DataOf(const Curve& curve, std::size_t measure, const SweepAxis& axis, bool numbers) {
  std::string data;
  for (const SweepGroup* group : curve.groups) {
    const std::size_t i = group->index.back();
    const double value = group->median[measure];
    data += (numbers ? axis.values[i] : std::to_string(i)) + " " +
            (std::isfinite(value) ? std::to_string(value) : "NaN") + "\n";
  }
  return data + "e\n";
}

std::string PanelScript(const Panel& panel, const std::vector<Curve>& curves, const SweepAxis& axis,
                        bool numbers) {
  std::string script = "set ylabel " + Quoted(panel.label) + "\nplot ", data;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    script += std::string(i == 0 ? "" : ", ") + "'-' with " + (numbers ? "linespoints" : "points") +
              " pt 7 ps 0.8 lw 2 lc rgb '" + Colour(i) + "' " +
              (curves[i].title.empty() ? "notitle" : "title " + Quoted(curves[i].title));
    data += DataOf(curves[i], panel.measure, axis, numbers);
  }
  return script + "\n" + data;
}

}  // namespace

void DrawSummary(const SweepSummary& summary, const std::filesystem::path& output,
                 const OutputRules& rules) {
  if (summary.axes.empty() || summary.groups.empty()) {
    throw InputError(
        output.string() +
        ": there is nothing to draw: the sweep has no axis other than its seeds, or no run yet");
  }
  const SweepAxis& axis = summary.axes.back();
  const bool numbers = std::all_of(axis.values.begin(), axis.values.end(), IsNumber);
  std::string script =
      PictureHead(output, 1200, 1200) +
      "set multiplot layout 3,2\nset grid\nset yrange [0:*]\nset key opaque\nset xlabel " +
      Quoted(axis.Column()) + "\nset offsets graph 0.02, graph 0.02\n";
  if (!numbers) {
    script += "set xtics rotate by -30 (";
    for (std::size_t i = 0; i < axis.values.size(); ++i) {
      script += (i == 0 ? "" : ", ") + Quoted(axis.values[i]) + " " + std::to_string(i);
    }
    script += ")\n";
  }
  const std::vector<Curve> curves = CurvesOf(summary);
  for (const Panel& panel : kPanels) script += PanelScript(panel, curves, axis, numbers);
  DrawPicture(script + "unset multiplot\n", output, rules);
}

}  // namespace flexarm
