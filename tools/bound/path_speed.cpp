#include "tools/bound/path_speed.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace flexarm {
namespace {

// A bound of the acceleration over z: base + slope z.
struct Line {
  double base, slope;
};

// All bounds of s'' over one piece: the least of `above`, the largest of `below`.
struct Bounds {
  std::array<Line, 3> above{}, below{};
  std::size_t count = 0;
  double largest_z;

  void Add(const Line& upper, const Line& lower) {
    above[count] = upper;
    below[count] = lower;
    ++count;
  }
  double Highest(double z) const {
    double least = above[0].base + above[0].slope * z;
    for (std::size_t i = 1; i < count; ++i)
      least = std::min(least, above[i].base + above[i].slope * z);
    return least;
  }
  // The largest z at which an acceleration fits; it fits at z = 0.
  double LargestZ() const {
    double z = largest_z;
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = 0; j < count; ++j) {
        const double closing = below[j].slope - above[i].slope;
        if (closing > 0.0) z = std::min(z, (above[i].base - below[j].base) / closing);
      }
    }
    return z;
  }
};

Bounds BoundsOver(const PathPiece& piece, const std::array<double, 2>& torque_nm, double step,
                  double next_z) {
  Bounds bounds;
  bounds.largest_z = piece.largest_speed_squared;
  bounds.Add({next_z / (2.0 * step), -0.5 / step}, {0.0, -0.5 / step});
  for (Eigen::Index i = 0; i < 2; ++i) {
    const double limit = torque_nm[static_cast<std::size_t>(i)];
    const double b = piece.b[i], a = piece.a[i] + b * step;  // z in the middle is z + step s''
    // A joint that the path's acceleration hardly loads: its velocity torque alone is limited.
    if (std::fabs(a) < 1e-12) {
      if (std::fabs(b) > 0.0) bounds.largest_z = std::min(bounds.largest_z, limit / std::fabs(b));
      continue;
    }
    const double reach = limit / std::fabs(a);
    bounds.Add({reach, -b / a}, {-reach, -b / a});
  }
  return bounds;
}

}  // namespace

std::vector<double> FastestSquaredSpeeds(std::span<const PathPiece> pieces, double step,
                                         const std::array<double, 2>& torque_nm) {
  const std::size_t last = pieces.size();
  std::vector<double> z(last + 1, 0.0);
  for (std::size_t k = last; k-- > 0;) {
    z[k] = BoundsOver(pieces[k], torque_nm, step, z[k + 1]).LargestZ();
  }
  z[0] = 0.0;
  for (std::size_t k = 0; k < last; ++k) {
    const Bounds bounds = BoundsOver(pieces[k], torque_nm, step, z[k + 1]);
    z[k + 1] = std::clamp(z[k] + 2.0 * step * bounds.Highest(z[k]), 0.0, z[k + 1]);
  }
  return z;
}

std::vector<double> TimesOver(std::span<const double> squared_speeds, double step) {
  std::vector<double> time_s = {0.0};
  for (std::size_t k = 1; k < squared_speeds.size(); ++k) {
    const double sum = std::sqrt(squared_speeds[k - 1]) + std::sqrt(squared_speeds[k]);
    time_s.push_back(time_s.back() + 2.0 * step / sum);
  }
  return time_s;
}

}  // namespace flexarm
