#pragma once

#include "tools/report/chapters.h"

namespace flexarm {

/// The start of the report, written when the chapters are done: the arm and its parameters, the
/// main result, a run of the config's law, and how many of the thesis's statements hold, if any.
void Overview(ReportContext* context, HtmlPage* page);

}  // namespace flexarm
