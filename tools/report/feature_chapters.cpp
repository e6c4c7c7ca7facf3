#include "tools/analysis/gauge_verification.h"
#include "tools/report/chapters.h"
#include "tools/thesis/appendix_statements.h"
#include "tools/thesis/control_features.h"

namespace flexarm {
void ControlFeatures(ReportContext* context, HtmlPage* page) {
  page->Section("Section 7.2: what makes the arm hard to control");
  Say(ControlFeatureStatements(context->config), context, page);
}

void AppendixB(ReportContext* context, HtmlPage* page) {
  page->Section("Appendix B: strain gauges");
  const auto figure = context->Figure("figure-B.2");
  DrawVerification(VerifyGauges(context->config, false), figure);
  page->Picture(figure,
                "Figure B.2: deflection of the links' tips by the gauges, and truly. Chapter 4's "
                "square wave, 0.4 and 0.1 N m; polynomial (B.1) from five half bridges a link at "
                "local maxima of strain, modal fit to the config's gauges; noise and quantisation "
                "of the config, without its analogue filter.");
  Say(AppendixStatements(context->config), context, page);
}

}  // namespace flexarm
