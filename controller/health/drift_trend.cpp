#include "controller/health/drift_trend.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <span>

namespace flexarm {
namespace {

constexpr double kTells = 0.3;      // of the prior's sigma
constexpr std::size_t kNewest = 3;  // runs of the mean
constexpr std::size_t kSlopeRuns = 10;
// Of an alarm that may be the effect of another, and of one that may have such effects: standard
// errors without the floor.
constexpr double kFaint = 10.0, kPlain = 50.0;

struct Point {
  double value, standard_error;
  const HealthRecord* run;
};

DriftFigure Mean(std::span<const Point> points) {
  double sum = 0.0, weight = 0.0;
  for (const Point& point : points) {
    const double w = 1.0 / (point.standard_error * point.standard_error);
    sum += w * point.value;
    weight += w;
  }
  return {.value = sum / weight, .standard_error = 1.0 / std::sqrt(weight)};
}

// Weighted least squares over the numbers of the runs.
DriftFigure Slope(std::span<const Point> points) {
  double w = 0.0, x = 0.0, xx = 0.0, y = 0.0, xy = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto at = static_cast<double>(i);
    const double weight = 1.0 / (points[i].standard_error * points[i].standard_error);
    w += weight, x += weight * at, xx += weight * at * at;
    y += weight * points[i].value, xy += weight * at * points[i].value;
  }
  const double spread = xx - x * x / w;
  return {.value = (xy - x * y / w) / spread, .standard_error = 1.0 / std::sqrt(spread)};
}

DriftFigure Difference(const DriftFigure& a, const DriftFigure& b) {
  return {.value = a.value - b.value,
          .standard_error = std::hypot(a.standard_error, b.standard_error)};
}

bool SameCalibration(const DriftChannel& channel, const HealthRecord& a, const HealthRecord& b) {
  if (channel.kind == DriftKind::kGaugeGain) {
    return a.gain_error[channel.strain] == b.gain_error[channel.strain];
  }
  if (channel.kind == DriftKind::kGaugeZero) {
    return a.zero_counts[channel.strain] == b.zero_counts[channel.strain];
  }
  return true;
}

std::vector<Point> PointsOf(std::size_t i, const DriftChannel& channel, const DriftScale& scale,
                            const HealthHistory& history) {
  std::vector<Point> points;
  const HealthRecord& newest = history.run.back();
  for (const HealthRecord& run : history.run) {
    if (run.plant != newest.plant || !SameCalibration(channel, run, newest)) {
      points.clear();
      continue;
    }
    const DriftFigure& figure = run.drift[i];
    if (!run.unused.empty() || figure.standard_error > kTells * scale.prior) continue;
    points.push_back({figure.value, figure.standard_error, &run});
  }
  return points;
}

DriftTrend TrendOf(const std::vector<Point>& points, double floor) {
  DriftTrend trend;
  trend.runs = points.size();
  if (points.empty()) return trend;
  const Point& newest = points.back();
  trend.newest = {.value = newest.value, .standard_error = newest.standard_error};
  if (points.size() < 2) return trend;
  const std::span<const Point> all(points);
  const std::size_t referred = std::min(kReferenceRuns, points.size() / 2);
  trend.reference = Mean(all.first(referred));
  trend.reference_utc = points[referred - 1].run->start_utc;
  const std::size_t others = points.size() - referred;
  trend.change = Difference(Mean(all.last(std::min(kNewest, others))), trend.reference);
  std::vector<DriftFigure> tests = {Difference(trend.newest, trend.reference), trend.change};
  const std::span<const Point> last = all.last(std::min(kSlopeRuns, points.size()));
  trend.per_run = Slope(last);
  if (last.size() > kNewest) {
    const auto span = static_cast<double>(last.size() - 1);
    tests.push_back({.value = span * trend.per_run.value,
                     .standard_error = span * trend.per_run.standard_error});
  }
  for (const DriftFigure& change : tests) {
    const double sigmas = change.value / std::hypot(change.standard_error, floor);
    if (std::fabs(sigmas) > std::fabs(trend.sigmas)) trend.sigmas = sigmas;
    trend.clarity = std::max(trend.clarity, std::fabs(change.value) / change.standard_error);
  }
  trend.change.standard_error = std::hypot(trend.change.standard_error, floor);
  trend.verdict =
      std::fabs(trend.sigmas) > kAlarmSigmas ? DriftVerdict::kDrifts : DriftVerdict::kSteady;
  return trend;
}

const char* AdviceFor(DriftKind kind) {
  switch (kind) {
    case DriftKind::kGaugeGain:
      return "check its glue and wiring, then `flexarm calibrate`";
    case DriftKind::kGaugeZero:
      return "check its glue and wiring, then `flexarm tare`";
    case DriftKind::kFriction:
      return "check bearing, gear and lubrication";
    case DriftKind::kJointStiffness:
      return "check gear and coupling for play and loose screws";
    case DriftKind::kLinkStiffness:
      return "check the link for cracks and its clamping, or the supply of all its gauges";
    case DriftKind::kPayload:
      return "check what the arm carries against what the runs state";
  }
  return "";
}

}  // namespace

std::vector<DriftTrend> DriftTrends(const std::vector<DriftChannel>& channels,
                                    const std::vector<DriftScale>& scales,
                                    const HealthHistory& history) {
  std::vector<DriftTrend> trends;
  if (history.run.empty()) return std::vector<DriftTrend>(channels.size());
  bool plain = false;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    trends.push_back(TrendOf(PointsOf(i, channels[i], scales[i], history), scales[i].floor));
    plain =
        plain || (trends.back().verdict == DriftVerdict::kDrifts && trends.back().clarity > kPlain);
  }
  for (DriftTrend& trend : trends) {
    if (plain && trend.clarity < kFaint) trend.verdict = DriftVerdict::kSteady;
  }
  return trends;
}

std::string FigureText(DriftKind kind, double value) {
  const ShownUnit shown = UnitOf(kind);
  const double number = shown.scale * value;
  const int digits = std::fabs(number) >= 9.95 ? 0 : kind == DriftKind::kFriction ? 3 : 1;
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), "%.*f %s", digits, number, shown.unit);
  return text.data();
}

std::string AlarmText(const DriftChannel& channel, const DriftTrend& trend) {
  const double change = trend.change.value;
  return channel.Name() + " " + FigureText(channel.kind, std::fabs(change)) + " (+-" +
         FigureText(channel.kind, trend.change.standard_error) + ") " +
         (change < 0.0 ? "lower" : "higher") + " than in the runs to " +
         trend.reference_utc.substr(0, 10) + "; " + AdviceFor(channel.kind);
}

}  // namespace flexarm
