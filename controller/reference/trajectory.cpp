#include "controller/reference/trajectory.h"

#include <cmath>
#include <cstddef>

#include "controller/reference/sampling_grid.h"
#include "controller/types/rejected_error.h"
#include "model/problem_list.h"
#include "model/units.h"

namespace flexarm {
namespace {

constexpr double kStartTolerance_rad = 1.0 / kDegPerRad;

/// Clamped cubic spline: continuous to the second derivative, slope 0 at both ends.
class Spline {
 public:
  Spline(const std::vector<TrajectoryPoint>& point, std::size_t joint) : point_(point) {
    const std::size_t n = point.size();
    y_.reserve(n);
    for (const TrajectoryPoint& p : point) y_.push_back(p.angle_rad[joint]);
    // Slopes m_i from the continuity of the second derivative, by elimination from above.
    slope_.assign(n, 0.0);
    std::vector<double> above(n, 0.0);
    for (std::size_t i = 1; i + 1 < n; ++i) {
      const double h0 = Width(i - 1), h1 = Width(i);
      const double right = 3.0 * ((y_[i] - y_[i - 1]) / h0 * h1 + (y_[i + 1] - y_[i]) / h1 * h0);
      const double pivot = 2.0 * (h0 + h1) - h1 * above[i - 1];
      above[i] = h0 / pivot;
      slope_[i] = (right - h1 * slope_[i - 1]) / pivot;
    }
    for (std::size_t i = n - 1; i-- > 1;) slope_[i] -= above[i] * slope_[i + 1];
  }

  // Times must not decrease from call to call.
  double At(double time_s) {
    while (piece_ + 2 < point_.size() && time_s > point_[piece_ + 1].time_s) ++piece_;
    const double h = Width(piece_), x = (time_s - point_[piece_].time_s) / h;
    const double y0 = y_[piece_], y1 = y_[piece_ + 1];
    const double m0 = h * slope_[piece_], m1 = h * slope_[piece_ + 1];
    return y0 + x * (m0 + x * (3.0 * (y1 - y0) - 2.0 * m0 - m1 + x * (2.0 * (y0 - y1) + m0 + m1)));
  }

 private:
  double Width(std::size_t i) const { return point_[i + 1].time_s - point_[i].time_s; }

  const std::vector<TrajectoryPoint>& point_;
  std::vector<double> y_, slope_;
  std::size_t piece_ = 0;
};

}  // namespace

std::array<std::vector<double>, 2> TrajectoryOnGrid(const CsvTrajectory& csv,
                                                    const std::array<double, 2>& from_rad,
                                                    double period_s) {
  const int periods = OnGrid(csv.duration_s(), period_s, csv.file + ": the last time_s");
  std::array<std::vector<double>, 2> angle_rad;
  for (std::size_t i = 0; i < 2; ++i) {
    const double offset = from_rad[i] - csv.point.front().angle_rad[i];
    if (std::fabs(offset) > kStartTolerance_rad) {
      throw RejectedError(csv.file + ": the first row puts joint " + NumberText(i + 1) + " at " +
                          NumberText(csv.point.front().angle_rad[i] * kDegPerRad) +
                          " deg, but the joint rests at " + NumberText(from_rad[i] * kDegPerRad) +
                          " deg then: they must agree within 1 deg");
    }
    Spline spline(csv.point, i);
    for (int k = 0; k <= periods; ++k) {
      const double faded =
          offset * (1.0 - ProfileAt(MoveProfile::kQuintic, static_cast<double>(k) / periods).s);
      angle_rad[i].push_back(spline.At(k * period_s) + faded - from_rad[i]);
    }
  }
  return angle_rad;
}

}  // namespace flexarm
