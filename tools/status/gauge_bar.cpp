#include "tools/status/gauge_bar.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>

namespace flexarm {
namespace {

constexpr double kCautionShare = 0.8;
constexpr int kLeastColumns = 5;  // brackets, zero, and a cell on each side

}  // namespace

StyledRow GaugeBar(double value, double limit, int columns) {
  if (columns < kLeastColumns) return {};
  const int half = (columns - 3) / 2;
  std::string cells(2 * static_cast<std::size_t>(half) + 1, ' ');
  const auto cell = [&](int i) { return std::next(cells.begin(), half + i); };
  *cell(0) = '|';
  const bool known = std::isfinite(value) && limit > 0.0;
  const double share = known ? value / limit : 0.0;
  const int side = share < 0.0 ? -1 : 1;
  const auto filled =
      static_cast<int>(std::lround(std::min(std::abs(share), 1.0) * static_cast<double>(half)));
  for (int i = 1; i <= filled; ++i) *cell(side * i) = '=';
  const bool beyond = std::abs(share) > 1.0;
  if (beyond) *cell(side * half) = side < 0 ? '<' : '>';
  const Look look = beyond                             ? Look::kBad
                    : std::abs(share) >= kCautionShare ? Look::kCaution
                                                       : Look::kGood;
  StyledRow row("[");
  row.Add(cells, look).Add("]");
  return row.PadTo(columns);
}

StyledRow ShareBar(double share, int columns) {
  if (columns < 3) return {};
  const int cells = columns - 2;
  const double cut = std::isfinite(share) ? std::clamp(share, 0.0, 1.0) : 0.0;
  const auto done = static_cast<std::size_t>(cut * static_cast<double>(cells));
  StyledRow row("[");
  row.Add(std::string(done, '#'), Look::kGood);
  return row.Add(std::string(static_cast<std::size_t>(cells) - done, '.')).Add("]");
}

}  // namespace flexarm
