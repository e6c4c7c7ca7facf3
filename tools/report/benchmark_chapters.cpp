#include "tools/benchmark/benchmark.h"
#include "tools/benchmark/limits_picture.h"
#include "tools/report/chapters.h"
#include "tools/report/study_figures.h"
#include "tools/support/parallel_for.h"

namespace flexarm {
namespace {

// Half the seeds of `flexarm benchmark`, so that the whole report takes only a few minutes.
constexpr const char* kMoveSeeds = "4001..4005";

/// Runs a benchmark table; the results go to a file in the report's folder.
/// @param what  text beside the progress bar
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

// The law with the highest score.
std::string BestOf(const BenchmarkTable& table) {
  std::size_t best = 0;
  for (std::size_t law = 1; law < table.laws.size(); ++law) {
    if (table.Score(law) > table.Score(best)) best = law;
  }
  return table.laws[best] + ", with a score of " + Figure(table.Score(best)) + " of 100 and " +
         Count(static_cast<std::ptrdiff_t>(table.Completed(best))) + " of " +
         Count(static_cast<std::ptrdiff_t>(table.Runs(best))) + " runs completed,";
}

}  // namespace

void Baselines(ReportContext* context, HtmlPage* page) {
  page->Section("The laws side by side");
  page->Paragraph(
      "The benchmark of docs/benchmark.md with one seed. The score is the share of the rests, in "
      "percent, in which the tip is settled.");
  const BenchmarkSet set =
      BenchmarkSetOf(BenchmarkKind::kCommands, context->config, context->experiments);
  const BenchmarkTable table = Run(*context, set, "1", "benchmark", "runs of the benchmark");
  Tell(table, page);
  context->results.push_back("Commands with light payloads and changed plants: " + BestOf(table) +
                             " comes to rest on its target soonest.");
}

void PayloadChapter(ReportContext* context, HtmlPage* page) {
  page->Section("The laws that estimate the payload");
  page->Paragraph(
      "Random smooth moves, payloads and seeds that no law was tuned on: four moves a run to "
      "random targets within 60 and 90 degrees to either side, each 1 to 1.5 times the duration "
      "that 1 kg needs, with rests of 1.5 s. Moves and noise are the same for every law. Settled "
      "in time: within 15 mm of the resting place 0.3 s after every move of the run, and that "
      "place "
      "within 15 mm of the target. Residual: the "
      "tip's rms in the last 0.3 s of the worst rest of a run; motion: its rms from 0.3 s after "
      "the move on, mean over the rests of a run (the residual of the design study).");
  const BenchmarkSet moves =
      BenchmarkSetOf(BenchmarkKind::kMoves, context->config, context->experiments);
  const BenchmarkTable table =
      Run(*context, Only(moves, {"nominal", "light"}), kMoveSeeds, "moves", "runs of the moves");
  Tell(table, page);
  context->results.push_back("Smooth moves with any payload from 0 to 1 kg, not told to the law: " +
                             BestOf(table) + " comes to rest on its target soonest.");

  BenchmarkSet plants = moves;
  plants.laws = PayloadLaws();
  page->Paragraph(
      "Results of the design study behind these laws beside the results here, on plants that the "
      "laws do not know. Reached: as many runs settle in time, and neither the mean motion nor the "
      "rms of the joints is more than 20 % above the design study's.");
  const TextTable study =
      StudyComparison(Run(*context, plants, kMoveSeeds, "plants", "runs of the plants"));
  page->Table(study.head, study.rows);

  page->Paragraph("Causes of the residual: the same moves with one limit after the other removed.");
  const BenchmarkTable limits =
      Run(*context, BenchmarkSetOf(BenchmarkKind::kLimits, context->config, context->experiments),
          kMoveSeeds, "limits", "runs of the limits");
  const auto figure = context->Figure("limits");
  DrawLimits(limits, figure);
  page->Picture(
      figure,
      "What limits the laws that estimate the payload: mean over the runs, and the largest.");
  Tell(limits, page);
}

}  // namespace flexarm
