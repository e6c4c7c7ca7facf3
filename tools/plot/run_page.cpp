#include "tools/plot/run_page.h"

#include <cmath>
#include <cstdio>
#include <limits>
#include <string_view>

#include "controller/runlog/build_info.h"
#include "run_page_generated.h"
#include "tools/html/html_page.h"
#include "tools/plot/plot_rows.h"
#include "tools/plot/run_marks.h"

namespace flexarm {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostPageRows = 4000, kMostPoses = 600;
constexpr int kPosePoints = 6;  // per link

// Seven digits are more than any sensor of a rig gives, and keep the page small.
Json Rounded(double value) {
  if (!std::isfinite(value)) return nullptr;
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.7g", value);
  return std::strtod(text.data(), nullptr);
}

Json ColumnsJson(const PlotRun& run) {
  const std::vector<PlotRow> rows = PlotRows(run, kMostPageRows);
  Json columns = Json::object();
  for (std::size_t column = 0; column < kPlotColumns; ++column) {
    Json values = Json::array();
    bool any = false;
    for (const PlotRow& row : rows) {
      values.push_back(Rounded(row[column]));
      any = any || std::isfinite(row[column]);
    }
    if (any) columns[kPlotKeys[column]] = std::move(values);
  }
  return columns;
}

Json PosesJson(const LoadedRun& run) {
  constexpr double kAlways = std::numeric_limits<double>::infinity();
  Json poses{{"time_s", Json::array()}, {"mm", Json::array()}};
  for (const PlotRun::Pose& pose : PosesOf(run, -kAlways, kAlways, kMostPoses, kPosePoints)) {
    Json points = Json::array();
    for (const auto& point : pose.point_m) {
      for (const double value : point) points.push_back(std::lround(1e3 * value));
    }
    poses["time_s"].push_back(Rounded(pose.time_s));
    poses["mm"].push_back(std::move(points));
  }
  return poses;
}

Json RunJson(const LoadedRun& loaded, const PlotRun& run) {
  Json json{
      {"title", run.title},
      {"details", run.details},
      {"command", run.command},
      {"trip", run.trip},
      {"samples", run.sample.size()},
      {"torque_limit_nm", run.torque_limit_nm},
      {"reach_m", loaded.config.arm.link[0].length_m() + loaded.config.arm.link[1].length_m()},
      {"marks", Json::array()},
      {"gaps", Json::array()},
      {"figures", run.metrics ? FigureLines(*run.metrics) : std::vector<std::string>{}},
      {"columns", ColumnsJson(run)},
      {"poses", PosesJson(loaded)}};
  for (const PlotRun::Mark& mark : run.mark) {
    json["marks"].push_back(
        {{"at_s", Rounded(mark.at_s)}, {"text", mark.text}, {"trips", mark.trips}});
  }
  for (const PlotRun::Gap& gap : run.gap) {
    json["gaps"].push_back({Rounded(gap.from_s), Rounded(gap.until_s)});
  }
  return json;
}

// Texts come from a log: none may end the element that holds them, or begin another.
std::string HarmlessJson(const Json& json) {
  std::string harmless;
  for (const char c : json.dump(-1, ' ', true, Json::error_handler_t::replace)) {
    harmless += c == '<' ? "\\u003c" : std::string(1, c);
  }
  return harmless;
}

void Fill(std::string_view name, const std::string& value, std::string* page) {
  for (std::size_t at = page->find(name); at != std::string::npos;
       at = page->find(name, at + value.size())) {
    page->replace(at, name.size(), value);
  }
}

}  // namespace

std::string RunPage(const std::vector<LoadedRun>& runs) {
  Json data{{"runs", Json::array()}};
  std::string title;
  for (const LoadedRun& loaded : runs) {
    const PlotRun run = PlotDataOf(loaded);
    title = runs.size() == 1 ? run.title : std::to_string(runs.size()) + " runs";
    data["runs"].push_back(RunJson(loaded, run));
  }
  std::string page = kRunPageTemplate;
  Fill("@TITLE@", EscapedHtml(title), &page);
  Fill("@BUILD@", EscapedHtml("flexarm " + ThisBuild().version + ", " + BuildId()), &page);
  Fill("@DATA@", HarmlessJson(data), &page);
  return page;
}

}  // namespace flexarm
