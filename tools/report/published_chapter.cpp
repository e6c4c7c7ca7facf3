#include <cmath>
#include <iomanip>
#include <sstream>

#include "tools/report/chapters.h"
#include "tools/report/published_results.h"

namespace flexarm {
namespace {

const char* VerdictOn(const PublishedResult& result) {
  if (result.within_tolerance()) return "agrees";
  return result.figure.differs ? "differs, see the note" : "DIFFERS";
}

// Without the zeros that a number of significant digits adds.
std::string AsPrinted(double value) {
  std::ostringstream text;
  text << std::setprecision(10) << value;
  return text.str();
}

std::string SourceOf(const PublishedCase& of) {
  return of.author + ": " + of.title + ". " + of.place + ", " + Count(of.year) + "; " + of.table +
         ". Read in: " + of.read_in + ".";
}

void CaseTable(const PublishedComparison& comparison, HtmlPage* page) {
  std::vector<std::vector<std::string>> rows;
  for (const PublishedResult& result : comparison.result) {
    const PublishedFigure& figure = result.figure;
    // One digit more than the tolerance can tell apart.
    const int digits =
        2 + static_cast<int>(std::ceil(std::log10(std::fabs(figure.published) / figure.tolerance)));
    rows.push_back({figure.symbol, LabelOf(figure), AsPrinted(figure.published),
                    Figure(result.computed, digits), Figure(result.computed - figure.published, 2),
                    AsPrinted(figure.tolerance), VerdictOn(result), figure.note});
  }
  page->Table(
      {"symbol", "figure", "published", "computed", "difference", "tolerance", "verdict", "note"},
      rows);
}

}  // namespace

void PublishedChapter(ReportContext* context, HtmlPage* page) {
  page->Section("Published arms");
  if (!std::filesystem::exists(context->published)) {
    page->Paragraph("There is no file of cases: " + context->published.string());
    return;
  }
  page->Paragraph(
      "The same program with the parameters of arms that other authors have published, against the "
      "figures that they print. A shape is scaled to the modal mass that the case states; the "
      "tolerance is in the unit of the figure.");
  for (const PublishedComparison& comparison : ComparePublished(context->published)) {
    const PublishedCase& of = comparison.of;
    page->Paragraph(of.name + (of.links == 1 ? " (one link). " : " (two links). ") + SourceOf(of));
    page->Paragraph("How the numbers were obtained: " + of.obtained +
                    " Tolerances: " + of.tolerance_reason + ".");
    CaseTable(comparison, page);
  }
}

}  // namespace flexarm
