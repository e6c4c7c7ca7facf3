// What the picture of a run says, in the script that gnuplot draws.

#include "tools/plot/plot_script.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <sstream>

#include "tests/tools/plot/plotted_run.h"
#include "tools/plot/gnuplot.h"
#include "tools/plot/run_marks.h"

namespace flexarm {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

RunMetrics WithoutARest() {
  RunMetrics metrics;
  metrics.joint_rms_error_deg = {1.0, 2.0};
  metrics.joint_final_error_deg = {kNone, kNone};
  metrics.tip_target_error_mm = metrics.tip_residual_rms_mm = kNone;
  return metrics;
}

std::string Joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

// The words of a picture: its labels and titles.
std::string LabelsOf(const std::string& script) {
  std::istringstream lines(script);
  std::string labels;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("set label") || line.starts_with("plot")) labels += line + "\n";
  }
  return labels;
}

TEST(FigureLines, SayInWordsWhatARunWasTooShortFor) {
  const std::string text = Joined(FigureLines(WithoutARest()));
  EXPECT_THAT(text, Not(HasSubstr("nan")));
  EXPECT_THAT(text, HasSubstr("ended before a rest"));
}

TEST(FigureLines, SayWhyATipIsNotSettled) {
  RunMetrics metrics;
  metrics.tip_target_error_mm = 16.0;
  metrics.tip_still_within_15mm_s = 0.2;
  EXPECT_THAT(Joined(FigureLines(metrics)), HasSubstr("not settled: 16 mm off its target"));
  metrics.tip_still_within_15mm_s.reset();
  EXPECT_THAT(Joined(FigureLines(metrics)), HasSubstr("not settled: still moving"));
  metrics.tip_target_error_mm = 1.0;
  metrics.tip_settling_time_s = metrics.tip_still_within_15mm_s = 0.46;
  EXPECT_THAT(Joined(FigureLines(metrics)), HasSubstr("settling: 0.46 s"));
}

// A run of one sample that tripped at once: nothing of a reference, of a target, of a payload.
TEST(PlotScript, OfARunWithoutValuesHasNoNanInItsWords) {
  PlotRun run = PlottedRun(1);
  PlotRun::Sample& only = run.sample[0];
  only.reference_deg = {kNone, kNone};
  only.target_mm = only.payload_kg = only.payload_sigma_kg = kNone;
  run.trip = "bending-strain-1: 0.002 of 0.0019 at 0 s";
  run.mark.push_back({0.0, "TRIP bending-strain-1", true});
  run.metrics = WithoutARest();
  const std::string script = PlotScript({run}, "run.png");
  EXPECT_THAT(LabelsOf(script), Not(HasSubstr("nan")));
  EXPECT_THAT(script, Not(HasSubstr("Payload estimate")));
  EXPECT_THAT(script, Not(HasSubstr("Tip to its target")));
  EXPECT_THAT(script, HasSubstr("TRIPPED: bending-strain-1: 0.002 of 0.0019"));
  const std::filesystem::path picture = testing::TempDir() + "/one_sample.svg";
  EXPECT_NO_THROW(DrawPicture(script, picture));
}

TEST(PlotScript, DrawsALimitIfItIsNearAndSaysItOtherwise) {
  PlotRun run = PlottedRun(100);
  EXPECT_THAT(PlotScript({run}, "run.png"), HasSubstr("Torque 1, N m; limit 30"));
  run.sample[50].applied_nm[0] = 20.0;
  run.sample[50].strain_share[1] = -1.1;
  const std::string script = PlotScript({run}, "run.png");
  EXPECT_THAT(script, Not(HasSubstr("Torque 1, N m; limit 30")));
  EXPECT_THAT(script, HasSubstr("-30 with lines"));
  EXPECT_THAT(script, HasSubstr("-100 with lines"));
  EXPECT_THAT(script, HasSubstr("Torque 2, N m; limit 6"));
}

TEST(PlotScript, ShadesMissingSamplesAndMarksEventsOnTheTimeAxis) {
  PlotRun run = PlottedRun(100);
  run.sample.erase(run.sample.begin() + 40, run.sample.begin() + 43);
  run.gap.push_back({0.78, 0.86, 3});
  run.mark.push_back({1.2, "payload 0 kg", false});
  const std::string script = PlotScript({run}, "run.png");
  EXPECT_THAT(script, HasSubstr("rectangle from 0.78, graph 0"));
  EXPECT_THAT(script, HasSubstr("3 samples missing"));
  EXPECT_THAT(script, HasSubstr("from 1.2, graph 0 to 1.2, graph 1 nohead"));
  EXPECT_THAT(script, HasSubstr("1.20 s   payload 0 kg"));
}

TEST(PlotScript, OfManyMovesSaysWhichAreShown) {
  PlotRun run = PlottedRun(1000);
  run.act.assign(50, run.act.front());
  run.view.assign(PlotRun::kMostViews, run.view.front());
  EXPECT_THAT(PlotScript({run}, "run.png"), HasSubstr("6 of 50 moves, evenly chosen"));
}

TEST(PlotScript, OfSeveralRunsNamesEachWithItsStyle) {
  PlotRun first = PlottedRun(100), second = PlottedRun(100);
  second.title = "waypoints, pd on rig";
  second.trip = "hub-rate-2: 11 of 10 at 0.5 s";
  second.mark.push_back({0.5, "TRIP hub-rate-2", true});
  const std::string script = PlotScript({first, second}, "runs.png");
  EXPECT_THAT(script, HasSubstr("1  waypoints, sobel on rig"));
  EXPECT_THAT(script, HasSubstr("2  waypoints, pd on rig"));
  EXPECT_THAT(script, HasSubstr("Tip deflection, mm, link 2"));
  EXPECT_THAT(script, HasSubstr("run 2: TRIP hub-rate-2"));
}

}  // namespace
}  // namespace flexarm
