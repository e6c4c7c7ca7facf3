#include "tools/benchmark/benchmark.h"
#include "tools/benchmark/limits_picture.h"
#include "tools/report/chapters.h"
#include "tools/report/study_figures.h"
#include "tools/support/parallel_for.h"

namespace flexarm {
namespace {

// Half of those of `flexarm benchmark`: the whole report takes a minute or two.
constexpr const char* kMoveSeeds = "4001..4005";

/// Runs a set into a file of the report's folder.
/// @param what  beside the progress bar
BenchmarkTable Run(const ReportContext& context, const BenchmarkSet& set, const std::string& seeds,
                   const std::string& file_name, const char* what) {
  const SweepPlan plan = BenchmarkPlan(context.config, set, {}, seeds);
  SweepFile file =
      SweepFile::Resume(context.folder / "tables" / (file_name + ".sqlite"), IdentityOf(plan));
  const std::vector<std::size_t> points = PointsToRun(&file, {});
  RunSweep(plan, points, &file, 0, ProgressBar(what, points.size()));
  return TableOf(set.kind, plan, file.Rows());
}

void Tell(const BenchmarkTable& table, HtmlPage* page) {
  for (const TablePart& part : TableParts(table)) {
    page->Paragraph(part.about);
    page->Table(part.table.head, part.table.rows);
  }
}

}  // namespace

void Baselines(ReportContext* context, HtmlPage* page) {
  page->Section("The laws side by side");
  page->Paragraph(
      "The benchmark of docs/benchmark.md with one seed. The score is the share of the rests, in "
      "percent, in which the tip is at rest.");
  const BenchmarkSet set =
      BenchmarkSetOf(BenchmarkKind::kCommands, context->config, context->experiments);
  Tell(Run(*context, set, "1", "benchmark", "runs of the benchmark"), page);
}

void PayloadChapter(ReportContext* context, HtmlPage* page) {
  page->Section("The laws that find the payload");
  page->Paragraph(
      "Random smooth moves, payloads and seeds that nothing was tuned on: four moves a run to "
      "anywhere in 60 and 90 degrees to either side, each 1 to 1.5 times the duration that 1 kg "
      "asks for, with rests of 1.5 s. The same moves and the same noise for every law. Settled in "
      "time: within 15 mm of the resting place 0.3 s after every move of the run. Residual: the "
      "tip's rms in the last 0.3 s of the worst rest of a run; motion: from 0.3 s after the move "
      "on, mean over the rests of a run, which is what the design study calls residual.");
  const BenchmarkSet moves =
      BenchmarkSetOf(BenchmarkKind::kMoves, context->config, context->experiments);
  Tell(Run(*context, Only(moves, {"nominal", "light"}), kMoveSeeds, "moves", "runs of the moves"),
       page);

  BenchmarkSet plants = moves;
  plants.laws = PayloadLaws();
  page->Paragraph(
      "The design study behind these laws, and what they do here, on plants that they do not "
      "know. Reached: as many runs settle in time, and neither the mean motion nor the rms of "
      "the joints is more than 20 % above the design study's.");
  const TextTable study =
      StudyComparison(Run(*context, plants, kMoveSeeds, "plants", "runs of the plants"));
  page->Table(study.head, study.rows);

  page->Paragraph(
      "What the residual is made of: the same moves with one limit after the other "
      "taken away.");
  const BenchmarkTable limits =
      Run(*context, BenchmarkSetOf(BenchmarkKind::kLimits, context->config, context->experiments),
          kMoveSeeds, "limits", "runs of the limits");
  const auto figure = context->Figure("limits");
  DrawLimits(limits, figure);
  page->Picture(figure,
                "What limits the laws that find the payload: mean over the runs, and the largest.");
  Tell(limits, page);
}

}  // namespace flexarm
