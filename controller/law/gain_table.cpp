#include "controller/law/gain_table.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <stdexcept>
#include <utility>

namespace flexarm {
namespace {

/// Position on an axis: between knots `first` and `first + 1`, at the fraction `share`.
struct Place {
  std::size_t first;
  double share;
};

Place PlaceIn(const std::vector<double>& knots, double x) noexcept {
  const auto above = std::upper_bound(knots.begin() + 1, knots.end() - 1, x);
  const auto first = static_cast<std::size_t>(above - knots.begin()) - 1;
  const double share = (x - knots[first]) / (knots[first + 1] - knots[first]);
  return {.first = first, .share = std::clamp(share, 0.0, 1.0)};
}

void RequireAscending(const std::vector<double>& knots) {
  if (knots.size() < 2 ||
      std::adjacent_find(knots.begin(), knots.end(), std::greater_equal<>()) != knots.end()) {
    throw std::invalid_argument("a gain table's axis must ascend and have at least two knots");
  }
}

}  // namespace

GainTable::GainTable(GainGrid grid, std::vector<Gain> knots)
    : grid_(std::move(grid)), knots_(std::move(knots)) {
  RequireAscending(grid_.payload_kg);
  RequireAscending(grid_.theta2_rad);
  if (knots_.size() != grid_.payload_kg.size() * grid_.theta2_rad.size()) {
    throw std::invalid_argument("a gain table needs a gain for every knot of its grid");
  }
}

GainTable::Gain GainTable::At(double payload_kg, double theta2_rad) const noexcept {
  const Place m = PlaceIn(grid_.payload_kg, payload_kg);
  const Place th2 = PlaceIn(grid_.theta2_rad, std::fabs(theta2_rad));
  const Gain low =
      (1.0 - th2.share) * Knot(m.first, th2.first) + th2.share * Knot(m.first, th2.first + 1);
  const Gain high = (1.0 - th2.share) * Knot(m.first + 1, th2.first) +
                    th2.share * Knot(m.first + 1, th2.first + 1);
  return (1.0 - m.share) * low + m.share * high;
}

}  // namespace flexarm
