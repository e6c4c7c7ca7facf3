#include "tools/plot/svg_chart.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "controller/types/rounded_text.h"
#include "tools/html/html_page.h"
#include "tools/plot/picture_style.h"
#include "tools/plot/plot_rows.h"

namespace flexarm {
namespace {

constexpr double kChartWidth_px = 960.0, kChartHeight_px = 210.0, kChartRight_px = 14.0,
                 kLegendLine_px = 18.0;
constexpr double kTimeAxis_px = 42.0, kCharacter_px = 6.9, kSample_px = 34.0;

std::string Px(double value) { return RoundedText(value, 1, true); }

/// Scales of one chart, and the text drawn so far.
class ChartDrawing {
 public:
  explicit ChartDrawing(const SvgChart& chart)
      : chart_(chart), left_px_(chart.row.empty() ? 72 : 132) {
    range_ = ValueRange{.low = std::numeric_limits<double>::infinity(),
                        .high = -std::numeric_limits<double>::infinity()};
    for (const SvgChart::Curve& curve : chart.curve) {
      for (const double y : curve.y) Widen(y);
    }
    KeepLimits();
    if (!chart.row.empty()) range_ = {.low = 0.0, .high = static_cast<double>(chart.row.size())};
    if (range_.empty()) range_ = {.low = -1.0, .high = 1.0};
    const double margin = chart.row.empty() ? 0.06 * (range_.high - range_.low) : 0.0;
    // A constant has a scale, too, which does not show its rounding.
    const double least =
        range_.low == range_.high ? std::max(0.5 * std::fabs(range_.high), 0.5) : 0.0;
    range_ = {.low = range_.low - std::max(margin, least),
              .high = range_.high + std::max(margin, least)};
  }

  std::string Text() {
    Legend();
    Axes();
    for (const double limit : limits_) {
      Line(left_px_, Y(limit), kChartWidth_px - kChartRight_px, Y(limit), SvgLimitStyle());
    }
    std::size_t style = 0;
    for (const SvgChart::Curve& curve : chart_.curve) {
      Curve(curve, curve.is_reference ? SvgReferenceStyle() : SvgCurveStyle(style++, 1.6));
    }
    Marks();
    return Head() + body_ + "</svg>";
  }

 private:
  void Widen(double y) {
    if (!std::isfinite(y)) return;
    range_ = {.low = std::min(range_.low, y), .high = std::max(range_.high, y)};
  }
  // A limit that would flatten the curves is not drawn.
  void KeepLimits() {
    const double largest =
        range_.empty() ? 0.0 : std::max(std::fabs(range_.low), std::fabs(range_.high));
    for (const double limit : chart_.limit) {
      if (std::fabs(limit) <= 3.0 * largest) limits_.push_back(limit);
    }
    for (const double limit : limits_) Widen(limit);
  }

  double X(double time_s) const {
    const double share = (time_s - chart_.from_s) / (chart_.until_s - chart_.from_s);
    return left_px_ + share * (kChartWidth_px - kChartRight_px - left_px_);
  }
  double Y(double value) const {
    return top_px_ + (range_.high - value) / (range_.high - range_.low) * kChartHeight_px;
  }
  double Bottom() const { return top_px_ + kChartHeight_px; }

  void Line(double x1, double y1, double x2, double y2, const std::string& style) {
    body_ +=
        "<path d=\"M" + Px(x1) + " " + Px(y1) + "L" + Px(x2) + " " + Px(y2) + "\" " + style + "/>";
  }
  void Words(double x, double y, const std::string& text, const char* anchor,
             const char* colour = kInkColour) {
    body_ += "<text x=\"" + Px(x) + "\" y=\"" + Px(y) + "\" text-anchor=\"" + anchor +
             "\" fill=\"" + colour + "\">" + EscapedHtml(text) + "</text>";
  }

  void LegendEntry(const std::string& label, const std::string& style) {
    const double width = kSample_px + 20.0 + kCharacter_px * static_cast<double>(label.size());
    if (legend_px_ + width > kChartWidth_px - kChartRight_px && legend_px_ > left_px_) {
      legend_px_ = left_px_;
      top_px_ += kLegendLine_px;
    }
    const double y = top_px_ - kLegendLine_px + 4.0;
    Line(legend_px_, y, legend_px_ + kSample_px, y, style);
    Words(legend_px_ + kSample_px + 5.0, y + 4.0, label, "start");
    legend_px_ += width;
  }
  void Legend() {
    legend_px_ = left_px_;
    std::size_t style = 0;
    for (const SvgChart::Curve& curve : chart_.curve) {
      LegendEntry(curve.label,
                  curve.is_reference ? SvgReferenceStyle() : SvgCurveStyle(style++, 1.6));
    }
    if (!chart_.limit.empty()) {
      LegendEntry(limits_.empty() ? "limit, outside of the chart" : "limit", SvgLimitStyle());
    }
  }

  void Axes() {
    const std::string grid = "fill=\"none\" stroke=\"#DDDDDD\" stroke-width=\"1\"";
    const double right_px = kChartWidth_px - kChartRight_px;
    if (chart_.row.empty()) {
      const double step = NiceStep(range_.high - range_.low, 5);
      for (double y = std::ceil(range_.low / step) * step; y <= range_.high; y += step) {
        Line(left_px_, Y(y), right_px, Y(y), grid);
        Words(left_px_ - 6.0, Y(y) + 4.0, RoundedText(std::fabs(y) < 1e-9 * step ? 0.0 : y, 4),
              "end");
      }
    }
    for (std::size_t i = 0; i < chart_.row.size(); ++i) {
      const auto low = static_cast<double>(i);
      Line(left_px_, Y(low), right_px, Y(low), grid);
      Words(left_px_ - 6.0, Y(low + 0.4) + 4.0, chart_.row[i], "end");
    }
    const double step = NiceStep(chart_.until_s - chart_.from_s, 10);
    for (double t = std::ceil(chart_.from_s / step) * step; t <= chart_.until_s; t += step) {
      Line(X(t), top_px_, X(t), Bottom(), grid);
      Words(X(t), Bottom() + 16.0, RoundedText(std::fabs(t) < 1e-9 * step ? 0.0 : t, 4), "middle");
    }
    body_ += "<rect x=\"" + Px(left_px_) + "\" y=\"" + Px(top_px_) + "\" width=\"" +
             Px(right_px - left_px_) + "\" height=\"" + Px(kChartHeight_px) +
             "\" fill=\"none\" stroke=\"#808080\"/>";
    Words(0.5 * (left_px_ + right_px), Bottom() + 34.0, chart_.time_label, "middle", kMutedColour);
    if (chart_.unit != "1") Words(4.0, top_px_ - 4.0, chart_.unit, "start", kMutedColour);
  }

  void Curve(const SvgChart::Curve& curve, const std::string& style) {
    std::string path;
    bool is_down = false;  // the pen
    for (std::size_t i = 0; i < chart_.time_s.size(); ++i) {
      const bool is_there = std::isfinite(curve.y[i]);
      if (is_there)
        path += (is_down ? "L" : "M") + Px(X(chart_.time_s[i])) + " " + Px(Y(curve.y[i]));
      is_down = is_there;
    }
    if (!path.empty()) body_ += "<path d=\"" + path + "\" " + style + "/>";
  }

  void Marks() {
    const std::string style =
        std::string("fill=\"none\" stroke=\"") + kLimitColour + "\" stroke-width=\"2\"";
    for (const SvgChart::Mark& mark : chart_.mark) {
      if (mark.at_s < chart_.from_s || mark.at_s > chart_.until_s) continue;
      Line(X(mark.at_s), top_px_, X(mark.at_s), Bottom(), style);
      const bool at_right = X(mark.at_s) > kChartWidth_px - 120.0;
      Words(X(mark.at_s) + (at_right ? -4.0 : 4.0), top_px_ + 14.0, mark.text,
            at_right ? "end" : "start", kLimitColour);
    }
  }

  std::string Head() const {
    return "<svg class=\"chart\" role=\"img\" "
           "aria-labelledby=\"" +
           chart_.id + "-title " + chart_.id + "-text\" viewBox=\"0 0 " + Px(kChartWidth_px) + " " +
           Px(Bottom() + kTimeAxis_px) +
           "\" font-family=\"DejaVu Sans,sans-serif\" "
           "font-size=\"12\"><title id=\"" +
           chart_.id + "-title\">" + EscapedHtml(chart_.title) + "</title><desc id=\"" + chart_.id +
           "-text\">" + EscapedHtml(chart_.description) +
           "</desc><rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>";
  }

  const SvgChart& chart_;
  double left_px_;
  double top_px_ = 2.0 * kLegendLine_px;  // of the plot: the legend is above it
  double legend_px_ = 0.0;
  ValueRange range_{};
  std::vector<double> limits_;
  std::string body_;
};

}  // namespace

std::string SvgChart::Text() const { return ChartDrawing(*this).Text(); }

}  // namespace flexarm
