#include <algorithm>
#include <cmath>
#include <limits>

#include "controller/types/rounded_text.h"
#include "tools/plot/svg_chart.h"
#include "tools/trip_report/trip_sections.h"

namespace flexarm {
namespace {

std::string Rounded(double value) { return RoundedText(value, 4); }

// The last value before a time; NaN: none.
double ValueAt(const SignalRows& rows, std::size_t signal, double time_s) {
  double value = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i < rows.time_s().size() && rows.time_s()[i] <= time_s; ++i) {
    if (std::isfinite(rows.value(signal)[i])) value = rows.value(signal)[i];
  }
  return value;
}

bool HasValue(const SignalRows& rows, std::size_t signal) {
  return std::ranges::any_of(rows.value(signal), [](double value) { return std::isfinite(value); });
}

std::string LimitText(const SignalPanel& panel) {
  if (panel.limit.empty()) return "";
  return " Limits " + Rounded(panel.limit.front()) + " and " + Rounded(panel.limit.back()) + " " +
         panel.unit + ".";
}

// "encoder: from -1.2 to 30.4, 30.4 at the trip".
std::string CurveText(const SignalRows& rows, std::size_t signal, const std::string& label,
                      bool with_trip) {
  const auto& values = rows.value(signal);
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  const double at_trip = ValueAt(rows, signal, 0.0);
  std::string text = label + ": from " + Rounded(low) + " to " + Rounded(high);
  if (with_trip && std::isfinite(at_trip)) text += ", " + Rounded(at_trip) + " at the trip";
  return text;
}

// An input in words: "limit-1-low opens +0.002 s".
std::string InputsText(const SignalPanel& panel, const SignalRows& rows, std::size_t first) {
  std::string text;
  for (std::size_t i = 0; i < panel.signal.size(); ++i) {
    const auto& value = rows.value(first + i);
    const double middle = static_cast<double>(i) + 0.5;
    for (std::size_t k = 1; k < value.size(); ++k) {
      if (!std::isfinite(value[k]) || !std::isfinite(value[k - 1])) continue;
      if ((value[k] > middle) == (value[k - 1] > middle)) continue;
      text += " " + panel.row[i] + (value[k] > middle ? " closes at " : " opens at ") +
              SignedSeconds(rows.time_s()[k]) + ".";
    }
  }
  return text.empty() ? "No input changes." : text.substr(1);
}

struct Span {
  double from_s, until_s;
  std::string id, when;
};

// @param first  number of the panel's first signal in `rows`
void AddChart(const SignalPanel& panel, const SignalRows& rows, std::size_t first, const Span& span,
              HtmlPage* page) {
  const bool with_trip = span.until_s > 0.0;
  SvgChart chart{.id = span.id + "-" + std::to_string(first),
                 .title = panel.title + ", " + span.when,
                 .description = "",
                 .unit = panel.unit,
                 .time_label = "time after the trip, s",
                 .from_s = span.from_s,
                 .until_s = span.until_s,
                 .time_s = rows.time_s(),
                 .curve = {},
                 .limit = panel.limit,
                 .mark = {{.at_s = 0.0, .text = "trip"}},
                 .row = panel.row};
  std::string said;
  for (std::size_t i = 0; i < panel.signal.size(); ++i) {
    if (!HasValue(rows, first + i)) continue;
    const PanelSignal& signal = panel.signal[i];
    chart.curve.push_back(
        {.label = signal.label, .y = rows.value(first + i), .is_reference = signal.is_reference});
    said += (said.empty() ? "" : "; ") + CurveText(rows, first + i, signal.label, with_trip);
  }
  if (chart.curve.empty()) {
    return page->Paragraph(panel.title + ": no values in this log.");
  }
  const std::string unit = panel.unit == "1" ? "" : " (" + panel.unit + ")";
  chart.description =
      panel.row.empty() ? said + "." + LimitText(panel) : InputsText(panel, rows, first);
  page->Svg(chart.Text(), chart.title + unit + ". " + chart.description);
}

void AddCharts(const TripReading& reading, const SignalRows& rows, const Span& span,
               HtmlPage* page) {
  std::size_t first = 0;
  for (const SignalPanel& panel : reading.panel) {
    AddChart(panel, rows, first, span, page);
    first += panel.signal.size();
  }
}

}  // namespace

void Signals(const TripReading& reading, HtmlPage* page) {
  page->Section("Signals of the last 10 s");
  if (reading.window.empty()) {
    page->Paragraph("The log has no samples of that time.");
  } else {
    page->Paragraph(
        "The trip is at 0 s. Curves of a chart differ by their dashes. A gap is a "
        "sample that is not in the log.");
    const double from_s = std::min(reading.window.time_s().front(), -0.1);
    const double until_s = std::max(reading.window.time_s().back(), 0.1);
    AddCharts(reading, reading.window,
              {.from_s = from_s, .until_s = until_s, .id = "late", .when = "around the trip"},
              page);
  }
  page->Section("Signals before that");
  if (reading.earlier.empty()) {
    return page->Paragraph("The log begins less than 10 s before the trip.");
  }
  page->Paragraph(
      "The least and the greatest value of each part of the time axis: no peak is lost. "
      "`flexarm export` writes every sample.");
  AddCharts(reading, reading.earlier,
            {.from_s = reading.earlier.time_s().front(),
             .until_s = -kWindowBefore_s,
             .id = "early",
             .when = "from the begin of the log"},
            page);
}

}  // namespace flexarm
