#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace flexarm {

/// A chart over time as one svg element, for pages that are written where gnuplot must not run:
/// flexarmd starts no other program.
///
/// Curves differ by their dashes as well as by their colours (picture_style.h). The element has a
/// title and a description for readers who do not see it. Every text is escaped.
struct SvgChart {
  struct Curve {
    std::string label;
    std::vector<double> y;      ///< one a time; NaN: no value, so the curve has a gap there
    bool is_reference = false;  ///< drawn as one
  };
  struct Mark {
    double at_s;
    std::string text;
  };

  std::string id;           ///< unique on the page; letters, digits and "-"
  std::string title;        ///< what is shown
  std::string description;  ///< the same in words and numbers
  std::string unit;         ///< of the values; "1": none
  std::string time_label;   ///< of the time axis, with its unit
  double from_s, until_s;   ///< of the time axis; from < until
  std::vector<double> time_s;
  std::vector<Curve> curve;
  std::vector<double>
      limit;               ///< lines; one far from all values is left out, and said in the legend
  std::vector<Mark> mark;  ///< lines across the chart, such as the trip
  /// Names of rows in place of a scale of values: row i shows curve values i to i + 1.
  std::vector<std::string> row;

  /// The svg element.
  std::string Text() const;
};

}  // namespace flexarm
