#include "tools/plot/plot_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace flexarm {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

PlotRow RowOf(const PlotRun::Sample& s) {
  return {s.time_s,
          s.reference_deg[0],
          s.reference_deg[1],
          s.angle_deg[0],
          s.angle_deg[1],
          s.asked_nm[0],
          s.asked_nm[1],
          s.applied_nm[0],
          s.applied_nm[1],
          s.gated_nm[0],
          s.gated_nm[1],
          100.0 * s.strain_share[0],
          100.0 * s.strain_share[1],
          s.deflection_mm[0],
          s.deflection_mm[1],
          s.target_mm,
          s.payload_kg,
          s.payload_sigma_kg};
}

PlotRow MissingAt(double time_s) {
  PlotRow row;
  row.fill(kMissing);
  row[kTimeColumn] = time_s;
  return row;
}

// The least and the greatest values of [first, last), at its first instant and at its middle.
void AppendExtremes(const std::vector<PlotRow>& rows, std::size_t first, std::size_t last,
                    std::vector<PlotRow>* out) {
  PlotRow least = rows[first], most = rows[first];
  for (std::size_t i = first; i < last; ++i) {
    for (std::size_t column = 1; column < kPlotColumns; ++column) {
      least[column] = std::fmin(least[column], rows[i][column]);  // of a number and NaN: the number
      most[column] = std::fmax(most[column], rows[i][column]);
    }
  }
  least[kSigmaColumn] = most[kSigmaColumn];  // no band is drawn narrower than it is
  most[kTimeColumn] = rows[(first + last) / 2][kTimeColumn];
  out->push_back(least);
  out->push_back(most);
}

}  // namespace

const std::array<const char*, kPlotColumns> kPlotKeys = {"time_s",
                                                         "reference_1_deg",
                                                         "reference_2_deg",
                                                         "angle_1_deg",
                                                         "angle_2_deg",
                                                         "torque_asked_1_nm",
                                                         "torque_asked_2_nm",
                                                         "torque_applied_1_nm",
                                                         "torque_applied_2_nm",
                                                         "torque_gated_1_nm",
                                                         "torque_gated_2_nm",
                                                         "strain_1_percent",
                                                         "strain_2_percent",
                                                         "deflection_1_mm",
                                                         "deflection_2_mm",
                                                         "tip_to_target_mm",
                                                         "payload_kg",
                                                         "payload_sigma_kg"};

std::vector<PlotRow> PlotRows(const PlotRun& run, std::size_t most) {
  std::vector<PlotRow> rows;
  std::size_t gap = 0;
  for (const PlotRun::Sample& sample : run.sample) {
    if (gap < run.gap.size() && sample.time_s > run.gap[gap].from_s) {
      rows.push_back(MissingAt(0.5 * (run.gap[gap].from_s + run.gap[gap].until_s)));
      ++gap;
    }
    rows.push_back(RowOf(sample));
  }
  if (rows.size() <= most) return rows;
  std::vector<PlotRow> decimated;
  const std::size_t parts = most / 2;
  for (std::size_t part = 0; part < parts; ++part) {
    const std::size_t first = part * rows.size() / parts, last = (part + 1) * rows.size() / parts;
    AppendExtremes(rows, first, last, &decimated);
  }
  return decimated;
}

ValueRange RangeOf(const std::vector<PlotRow>& rows, std::size_t column, std::size_t columns) {
  ValueRange range{std::numeric_limits<double>::infinity(),
                   -std::numeric_limits<double>::infinity()};
  for (const PlotRow& row : rows) {
    for (std::size_t i = column; i < column + columns; ++i) {
      if (!std::isfinite(row[i])) continue;
      range = {std::min(range.low, row[i]), std::max(range.high, row[i])};
    }
  }
  return range;
}

double NiceStep(double range, int parts) {
  const double rough = std::max(range, 1e-9) / parts;
  const double decade = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (step * decade >= rough * (1.0 - 1e-9)) return step * decade;
  }
  return 10.0 * decade;
}

}  // namespace flexarm
