#include <cmath>

#include "controller/host/simulation.h"
#include "tools/plot/plot_data.h"
#include "tools/report/chapters.h"
#include "tools/report/loop_picture.h"
#include "tools/support/parallel_for.h"
#include "tools/sweep/better_sensors.h"
#include "tools/thesis/chapter7_statements.h"
#include "tools/thesis/control_study.h"

namespace flexarm {
namespace {

using Row = std::vector<std::string>;

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
};

std::vector<PlotRun> RunAll(const ReportContext& context, const std::vector<NamedRun>& runs) {
  std::vector<PlotRun> plots(runs.size());
  ParallelFor(runs.size(), [&](std::size_t i) {
    const NamedRun& run = runs[i];
    const std::filesystem::path log = context.folder / "runs" / (run.file + ".flexarm");
    Simulate({.config = WithOverrides(context.config, run.overrides),
              .experiment = ControlCommand(run.shape),
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
          Cell(f.settling_s.median),
          Cell(f.last_second_mm.median),
          pair(f.peak_nm),
          pair(f.peak_bending_mm)};
}

Row FigureHead(const std::string& first) {
  return {first,         "completed",  "rms error, deg",   "final error, deg",
          "settling, s", "motion, mm", "peak torque, N m", "peak bending, mm"};
}

void AlphaAndVartheta(const ControlStudy& study, const ReportContext& context, HtmlPage* page) {
  const std::vector<PlotRun> runs = RunAll(
      context, {{"alpha 0, vartheta 0",
                 "alpha0-vartheta0",
                 {"controller.alpha=0", "controller.vartheta=0"},
                 0.1},
                {"alpha 3, vartheta 0", "alpha3-vartheta0", {"controller.vartheta=0"}, 0.1},
                {"alpha 3, vartheta 0.5", "alpha3-vartheta0.5", {"controller.vartheta=0.5"}, 0.1}});
  const auto figure = context.Figure("figure-7.1-7.3");
  DrawLoopRuns(runs, "Effect of alpha and vartheta, 0.1 kg", figure);
  page->Picture(figure,
                "Figures 7.1 to 7.3: effect of alpha and vartheta on bending, joint "
                "trajectory and control effort; the reference is dashed.");
  std::vector<Row> rows;
  for (const double alpha : kAlphas) {
    for (const double payload_kg : kTestedPayloads_kg) {
      rows.push_back(FigureRow("alpha " + Figure(alpha, 2) + ", " + Kilograms(payload_kg),
                               study.Of(AlphaCase(alpha, payload_kg))));
    }
  }
  page->Table(FigureHead("vartheta 0.35"), rows);
  rows.clear();
  for (const char* sign : {"printed", "corrected"}) {
    for (const double vartheta : kVarthetas) {
      rows.push_back(FigureRow("vartheta " + Figure(vartheta, 2) + ", (7.25) " + sign,
                               study.Of(VarthetaCase(vartheta, sign))));
    }
  }
  page->Table(FigureHead("alpha 3, 0.1 kg"), rows);
}

// Figures 7.4 to 7.12: the thesis's simulations know the state; here the sensors are ideal as far
// as the config allows, and the delay of one sample stays.
std::vector<std::string> IdealSensors(const RigConfig& config) {
  constexpr double kFiner = 4000.0;  // 1e7 counts per turn
  std::vector<std::string> overrides = QuietGauges();
  const std::vector<std::string> fine = FinerEncoders(config.sensors, kFiner);
  overrides.insert(overrides.end(), fine.begin(), fine.end());
  return overrides;
}

void PayloadFigures(const ReportContext& context, HtmlPage* page) {
  struct Set {
    const char *file, *caption;
    DoubletShape shape;
    bool ideal;
    std::vector<double> payload_kg;
  };
  const std::vector<Set> sets = {
      {"figure-7.4-7.12",
       "Figures 7.4 to 7.12 (simulation): square command, sensors without noise "
       "and quantisation.",
       DoubletShape::kSquare,
       true,
       {0.01, 0.1, 0.2}},
      {"figure-7.14-7.25",
       "Figures 7.14 to 7.25 (experiment; here the simulated rig): square "
       "command, real sensors.",
       DoubletShape::kSquare,
       false,
       {0.0, 0.01, 0.1, 0.2}},
      {"figure-7.26-7.34",
       "Figures 7.26 to 7.34 (experiment; here the simulated rig): sine "
       "command, real sensors.",
       DoubletShape::kSine,
       false,
       {0.01, 0.1, 0.2}}};
  for (const Set& set : sets) {
    std::vector<NamedRun> runs;
    for (const double payload_kg : set.payload_kg) {
      const std::string name = Kilograms(payload_kg);
      runs.push_back({name, std::string(set.file) + "-" + name.substr(0, name.find(' ')),
                      set.ideal ? IdealSensors(context.config) : std::vector<std::string>{},
                      payload_kg, set.shape});
    }
    const auto figure = context.Figure(set.file);
    DrawLoopRuns(RunAll(context, runs), set.caption, figure);
    page->Picture(figure, set.caption);
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
  }
  page->Table(FigureHead("modified Sobel law"), rows);
}

}  // namespace

void Chapter7(ReportContext* context, HtmlPage* page) {
  page->Section("Chapter 7: control");
  page->Paragraph(
      "A doublet of 1 s turns both joints by 30 degrees, a second one 2 s later turns them back. "
      "Sensors with noise and quantisation, one sample of delay, a plant with four modes a link; "
      "medians over " +
      std::to_string(ControlStudy::kSeeds) + " seeds.");
  const ControlStudy study(context->config, 1,
                           ProgressBar("runs of chapter 7", ControlStudy::Runs()));
  AlphaAndVartheta(study, *context, page);
  PayloadFigures(*context, page);
  PayloadTable(study, page);
  const std::vector<Statement> statements = Chapter7Statements(study);
  page->Statements(statements);
  context->statements.insert(context->statements.end(), statements.begin(), statements.end());
}

}  // namespace flexarm
