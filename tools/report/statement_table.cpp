#include "tools/report/chapters.h"

namespace flexarm {
namespace {

const char* ClassOf(Verdict verdict) {
  switch (verdict) {
    case Verdict::kHolds:
      return "v holds";
    case Verdict::kInPart:
      return "v part";
    case Verdict::kDepends:
      return "v depends";
    case Verdict::kDoesNot:
      return "v does-not";
    case Verdict::kNotTested:
      return "v not";
  }
  return "v";
}

std::string Cell(const std::string& text) { return "<td>" + EscapedHtml(text) + "</td>"; }

}  // namespace

void Say(const std::vector<Statement>& statements, ReportContext* context, HtmlPage* page) {
  std::string table =
      "<div class=\"box\"><table>\n<tr><th scope=\"col\">section</th><th scope=\"col\">the thesis "
      "says</th><th scope=\"col\">the model says</th><th scope=\"col\">verdict</th></tr>\n";
  for (const Statement& s : statements) {
    table += "<tr>" + Cell(s.section) + Cell(s.thesis) + Cell(s.model) + "<td class=\"" +
             ClassOf(s.verdict) + "\">" + ToString(s.verdict) + "</td></tr>\n";
  }
  page->Markup(table + "</table></div>\n");
  context->statements.insert(context->statements.end(), statements.begin(), statements.end());
}

}  // namespace flexarm
