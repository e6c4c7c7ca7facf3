#include <algorithm>

#include "config/thesis_arm.h"
#include "controller/types/rounded_text.h"
#include "controller/types/tip_tolerance.h"
#include "tools/benchmark/benchmark.h"
#include "tools/benchmark/limits_picture.h"
#include "tools/report/chapters.h"
#include "tools/report/study_figures.h"
#include "tools/support/parallel_for.h"
#include "tools/sweep/random_moves.h"

namespace flexarm {
namespace {

// The first seeds of `flexarm benchmark`; half of them by default, so that the whole report takes
// only a few minutes.
std::string MoveSeeds(const ReportContext& context) {
  constexpr int kFirst = 4001;
  return std::to_string(kFirst) + ".." + std::to_string(kFirst + context.runs - 1);
}

// Without the laws that the report is not asked for.
BenchmarkSet Asked(BenchmarkSet set, const std::vector<std::string>& laws) {
  if (laws.empty()) return set;
  const auto is_asked = [&laws](const std::string& name) {
    return std::find(laws.begin(), laws.end(), name) != laws.end();
  };
  std::erase_if(set.laws, [&](const std::string& law) { return !is_asked(law); });
  return set;
}

BenchmarkSet SetOf(BenchmarkKind kind, const ReportContext& context) {
  return Asked(BenchmarkSetOf(kind, context.config, context.experiments), context.laws);
}

// A table without a law is left out; says why.
bool HasLaws(const BenchmarkSet& set, HtmlPage* page) {
  if (!set.laws.empty()) return true;
  std::string why = "No law of the report is for this table.";
  for (const LeftOut& out : set.left_out) why += " " + out.name + ": " + out.why + ".";
  page->Paragraph(why);
  return false;
}

std::string PayloadText(double payload_kg) { return RoundedText(payload_kg, 3) + " kg"; }

/// Runs a benchmark table; the results go to a file in the report's folder.
/// @param what  text beside the progress bar
BenchmarkTable Run(const ReportContext& context, const BenchmarkSet& set, const std::string& seeds,
                   const std::string& file_name, const char* what) {
  const SweepPlan plan = BenchmarkPlan(context.config, set, {}, seeds);
  SweepFile file =
      SweepFile::Resume(context.folder / "tables" / (file_name + ".sqlite"), IdentityOf(plan));
  const std::vector<std::size_t> points = PointsToRun(&file, {});
  RunSweep(plan, points, &file, 0, ProgressBar(what, points.size()));
  return TableOf(set, plan, file.Rows());
}

void Tell(const BenchmarkTable& table, HtmlPage* page) {
  for (const TablePart& part : TableParts(table)) {
    page->Paragraph(part.about);
    page->Table(part.table.head, part.table.rows);
  }
}

// The law with the highest score, as the end of a sentence.
std::string BestOf(const BenchmarkTable& table) {
  std::size_t best = 0;
  for (std::size_t law = 1; law < table.laws.size(); ++law) {
    if (table.Score(law) > table.Score(best)) best = law;
  }
  if (table.Score(best) <= 0.0) return "no law comes to rest on its target.";
  return table.laws[best] + ", with a score of " + Figure(table.Score(best)) + " of 100 and " +
         Count(static_cast<std::ptrdiff_t>(table.Completed(best))) + " of " +
         Count(static_cast<std::ptrdiff_t>(table.Runs(best))) +
         " runs completed, comes to rest on its target soonest.";
}

// What the moves are, and what the columns of their tables.
std::string AboutMoves(const RigConfig& config) {
  const MoveRecipe recipe = RecipeFor(config);
  const std::string within_mm = Figure(1e3 * SettledWithin_m(config), 2) + " mm";
  return "Random smooth moves" +
         std::string(IsThesisArm(config.arm) ? ", payloads and seeds that no law was tuned on"
                                             : "") +
         ": four moves a run to random targets within " + Figure(recipe.within_deg[0], 2) +
         " and " + Figure(recipe.within_deg[1], 2) +
         " degrees to either side, each 1 to 1.5 times the duration that " +
         PayloadText(recipe.rule_for_kg) +
         " needs, with rests of 1.5 s. Moves and noise are the same for every law. Settled in "
         "time: within " +
         within_mm +
         " of the resting place 0.3 s after every move of the run, and that place within " +
         within_mm +
         " of the target. Residual: the tip's rms in the last 0.3 s of the worst rest of a run; "
         "motion: its rms from 0.3 s after the move on, mean over the rests of a run.";
}

// Two laws on plants that they do not know; beside the design study for its arm.
void Plants(const ReportContext& context, BenchmarkSet moves, HtmlPage* page) {
  const std::vector<std::string> payload_laws = PayloadLaws();
  std::erase_if(moves.laws, [&](const std::string& law) {
    return std::find(payload_laws.begin(), payload_laws.end(), law) == payload_laws.end();
  });
  page->Paragraph("The laws that estimate the payload on plants that they do not know.");
  if (!HasLaws(moves, page)) return;
  const BenchmarkTable table =
      Run(context, moves, MoveSeeds(context), "plants", "runs of the plants");
  if (!IsThesisArm(context.config.arm)) {
    Tell(table, page);
    return;
  }
  page->Paragraph(
      "Results of the design study behind these laws beside the results here. Reached: as many "
      "runs settle in time, and neither the mean motion nor the rms of the joints is more than "
      "20 % above the design study's.");
  const TextTable study = StudyComparison(table);
  page->Table(study.head, study.rows);
}

void Limits(const ReportContext& context, HtmlPage* page) {
  page->Paragraph("Causes of the residual: the same moves with one limit after the other removed.");
  const BenchmarkSet set = SetOf(BenchmarkKind::kLimits, context);
  if (!HasLaws(set, page)) return;
  const BenchmarkTable limits =
      Run(context, set, MoveSeeds(context), "limits", "runs of the limits");
  const auto figure = context.Figure("limits");
  DrawLimits(limits, figure);
  page->Picture(
      figure,
      "What limits the laws that estimate the payload: mean over the runs, and the largest.");
  Tell(limits, page);
}

}  // namespace

void Baselines(ReportContext* context, HtmlPage* page) {
  page->Section("The laws side by side");
  page->Paragraph(
      "The benchmark of docs/benchmark.md with one seed. The score is the share of the rests, in "
      "percent, in which the tip is settled.");
  const BenchmarkSet set = SetOf(BenchmarkKind::kCommands, *context);
  if (!HasLaws(set, page)) return;
  const BenchmarkTable table = Run(*context, set, "1", "benchmark", "runs of the benchmark");
  Tell(table, page);
  const bool is_thesis = IsThesisArm(context->config.arm);
  context->results.push_back(std::string("Commands with ") + (is_thesis ? "light" : "several") +
                             " payloads and changed plants: " + BestOf(table));
}

void PayloadChapter(ReportContext* context, HtmlPage* page) {
  page->Section("The laws that estimate the payload");
  page->Paragraph(AboutMoves(context->config));
  const BenchmarkSet moves = SetOf(BenchmarkKind::kMoves, *context);
  if (!HasLaws(moves, page)) return;
  const BenchmarkTable table = Run(*context, Only(moves, {"nominal", "light"}), MoveSeeds(*context),
                                   "moves", "runs of the moves");
  Tell(table, page);
  const auto [least_kg, most_kg] = RecipeFor(context->config).payload_kg;
  context->results.push_back("Smooth moves with any payload from " + RoundedText(least_kg, 3) +
                             " to " + PayloadText(most_kg) +
                             ", not told to the law: " + BestOf(table));
  Plants(*context, moves, page);
  Limits(*context, page);
}

}  // namespace flexarm
