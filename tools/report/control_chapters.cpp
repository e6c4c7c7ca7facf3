#include <cmath>

#include "controller/host/simulation.h"
#include "controller/types/law_table.h"
#include "estimator/state_layout.h"
#include "tools/plot/plot_data.h"
#include "tools/report/chapters.h"
#include "tools/report/loop_picture.h"
#include "tools/support/parallel_for.h"
#include "tools/thesis/chapter7_statements.h"
#include "tools/thesis/control_study.h"

namespace flexarm {
namespace {

using Row = std::vector<std::string>;

constexpr double kNominal_kg = 0.1;  // of the nominal model, thesis 7.4

std::string Kilograms(double payload_kg) {
  std::string text = std::to_string(payload_kg);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text + " kg";
}

// A run of the pictures, with its log in the report's folder.
struct NamedRun {
  std::string name;  ///< legend in the picture
  std::string file;
  std::vector<std::string> overrides;
  double payload_kg;
  DoubletShape shape = DoubletShape::kSquare;
  double move_deg = kMove_deg;
};

std::vector<PlotRun> RunAll(const ReportContext& context, const std::vector<NamedRun>& runs) {
  std::vector<PlotRun> plots(runs.size());
  ParallelFor(runs.size(), [&](std::size_t i) {
    const NamedRun& run = runs[i];
    const std::filesystem::path log = context.folder / "runs" / (run.file + ".flexarm");
    Simulate({.config = WithOverrides(context.config, run.overrides),
              .experiment = ControlCommand(run.shape, run.move_deg),
              .payload_kg = run.payload_kg,
              .log = log});
    plots[i] = PlotDataOf(LoadRun(log));
    plots[i].name = run.name;
  });
  return plots;
}

std::string Cell(double value) {
  if (std::isnan(value)) return "-";
  return std::isinf(value) ? "never" : Figure(value);
}

Row FigureRow(const std::string& name, const ControlFigures& f) {
  const auto pair = [](const std::array<OverSeeds, 2>& v) {
    return Cell(v[0].median) + " " + Cell(v[1].median);
  };
  return {name,
          std::to_string(f.completed) + "/" + std::to_string(f.runs),
          pair(f.rms_deg),
          pair(f.final_deg),
          Cell(f.still_15mm_s.median),
          Cell(f.last_second_mm.median),
          pair(f.peak_nm),
          pair(f.peak_bending_mm)};
}

Row FigureHead(const std::string& first) {
  return {first,         "completed",  "rms error, deg",   "final error, deg",
          "settling, s", "motion, mm", "peak torque, N m", "peak bending, mm"};
}

constexpr std::array<LoopView, 3> kViews = {LoopView::kBending, LoopView::kTrajectory,
                                            LoopView::kEffort};

// The settings of a figure, for its caption.
std::string SettingsOf(const RigConfig& config, bool ideal) {
  return std::string(ideal ? "Known state, no delay"
                           : "The simulated rig with sensors, estimator and delay") +
         "; law " + LawOf(config.controller.kind).name + ", nominal model " +
         std::string(NameOf(config.controller.nominal)) + ", " +
         Figure(static_cast<double>(config.sim.plant_modes), 1) + " modes a link in the plant";
}

std::string Gains(const RigConfig& config) {
  return "alpha " + Figure(config.controller.alpha, 2) + ", vartheta " +
         Figure(config.controller.vartheta, 2);
}

// Figures first, first + 1 and first + 2: the same runs in the three views.
void ThreeFigures(const ReportContext& context, int first, const std::vector<PlotRun>& runs,
                  const std::string& caption, HtmlPage* page) {
  for (const LoopView view : kViews) {
    const std::string number = "7." + std::to_string(first + static_cast<int>(view));
    const auto figure = context.Figure("figure-" + number);
    DrawLoopRuns(runs, view, figure);
    page->Picture(figure, "Figure " + number + ": " + TitleOf(view) + ". " + caption);
  }
}

// The curves of the thesis (alpha 0 with vartheta 0, alpha 3 with 0 and 0.5), alpha 0 as the table
// has it, and an alpha above the best.
void EffectOfAlphaAndVartheta(const ReportContext& context, HtmlPage* page) {
  const std::string own = Figure(context.config.controller.vartheta, 2);
  const auto run = [](const std::string& alpha, const std::string& vartheta) {
    return NamedRun{
        "alpha " + alpha + ", vartheta " + vartheta,
        "alpha" + alpha + "-vartheta" + vartheta,
        {"controller.alpha=" + alpha, "controller.vartheta=" + vartheta, "estimator.name=ideal"},
        kNominal_kg};
  };
  const std::vector<PlotRun> runs =
      RunAll(context, {run("0", "0"), run("0", own), run("3", "0"), run("3", "0.5"),
                       run(Figure(kAlphas.back(), 1), "0.5")});
  ThreeFigures(context, 1, runs,
               "Effect of alpha and vartheta, " + Kilograms(kNominal_kg) + ", square command of " +
                   Figure(kMove_deg, 2) + " deg. " + SettingsOf(context.config, true) +
                   "; a curve ends where the run trips.",
               page);
}

void AlphaAndVartheta(const ControlStudy& study, const ReportContext& context, HtmlPage* page) {
  EffectOfAlphaAndVartheta(context, page);
  const std::string own = Figure(context.config.controller.vartheta, 2);
  std::vector<Row> rows;
  for (const double alpha : kAlphas) {
    for (const double payload_kg : kTestedPayloads_kg) {
      rows.push_back(FigureRow("alpha " + Figure(alpha, 2) + ", " + Kilograms(payload_kg),
                               study.Of(AlphaCase(alpha, payload_kg))));
    }
  }
  page->Table(FigureHead("with sensors, vartheta " + own), rows);
  rows.clear();
  for (const char* sign : {"printed", "corrected"}) {
    for (const double vartheta : kVarthetas) {
      rows.push_back(FigureRow("vartheta " + Figure(vartheta, 2) + ", (7.25) " + sign,
                               study.Of(VarthetaCase(vartheta, sign))));
    }
  }
  page->Table(FigureHead("with sensors, alpha " + Figure(context.config.controller.alpha, 2) +
                         ", " + Kilograms(kNominal_kg)),
              rows);
}

// Three figures for each payload of a set.
struct PayloadSet {
  int first;  ///< number of the first figure
  const char* about;
  DoubletShape shape;
  double move_deg;
  bool ideal;
  std::vector<double> payload_kg;
};

void PayloadFigures(const ReportContext& context, HtmlPage* page) {
  const std::vector<PayloadSet> sets = {
      {4, "Simulation", DoubletShape::kSquare, kMove_deg, true, {0.01, 0.1, 0.2}},
      {14,
       "Experiment, square wave",
       DoubletShape::kSquare,
       kMove_deg,
       false,
       {0.0, 0.01, 0.1, 0.2}},
      {26,
       "Experiment, sine with the square wave's amplitude",
       DoubletShape::kSine,
       SmallSineCase(kNominal_kg).move_deg,
       false,
       {0.01, 0.1, 0.2}}};
  for (const PayloadSet& set : sets) {
    std::vector<NamedRun> runs;
    for (const double payload_kg : set.payload_kg) {
      runs.push_back({Kilograms(payload_kg),
                      "figure-7." + std::to_string(set.first + 3 * static_cast<int>(runs.size())),
                      set.ideal ? Overrides{"estimator.name=ideal"} : Overrides{}, payload_kg,
                      set.shape, set.move_deg});
    }
    const std::vector<PlotRun> plots = RunAll(context, runs);
    for (std::size_t i = 0; i < runs.size(); ++i) {
      ThreeFigures(context, set.first + 3 * static_cast<int>(i), {plots[i]},
                   std::string(set.about) + ", payload " + Kilograms(runs[i].payload_kg) +
                       ", joints turn by " + Figure(set.move_deg, 3) + " deg. " +
                       SettingsOf(context.config, set.ideal) + "; " + Gains(context.config) + ".",
                   page);
    }
  }
}

void PayloadTable(const ControlStudy& study, HtmlPage* page) {
  std::vector<Row> rows;
  for (const double payload_kg : kAllPayloads_kg) {
    rows.push_back(
        FigureRow("square, " + Kilograms(payload_kg), study.Of(ChangedCase({}, payload_kg))));
    rows.push_back(FigureRow("the same without adaptation",
                             study.Of(ChangedCase({"controller.adaptation=false"}, payload_kg))));
  }
  for (const double payload_kg : kTestedPayloads_kg) {
    rows.push_back(FigureRow("sine, " + Kilograms(payload_kg), study.Of(SineCase(payload_kg))));
    rows.push_back(FigureRow("sine of the same amplitude", study.Of(SmallSineCase(payload_kg))));
  }
  page->Table(FigureHead("modified Sobel law"), rows);
}

}  // namespace

void Chapter7(ReportContext* context, HtmlPage* page) {
  page->Section("Chapter 7: control");
  page->Paragraph(
      "A doublet of 1 s turns both joints by " + Figure(kMove_deg, 2) +
      " degrees, a second one 2 s later turns them back. In the tables: sensors with noise and "
      "quantisation, one sample of delay; medians over " +
      std::to_string(ControlStudy::kSeeds) +
      " seeds; settling within 15 mm, motion of the tip in the last second.");
  const ControlStudy study(context->config, 1,
                           ProgressBar("runs of chapter 7", ControlStudy::Runs(context->config)));
  AlphaAndVartheta(study, *context, page);
  PayloadFigures(*context, page);
  PayloadTable(study, page);
  Say(Chapter7Statements(study), context, page);
}

}  // namespace flexarm
