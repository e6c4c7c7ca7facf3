#pragma once

#include <Eigen/Core>
#include <vector>

namespace flexarm {

/// Where a table has its knots: ascending, at least two of each.
struct GainGrid {
  std::vector<double> payload_kg;
  std::vector<double> theta2_rad;  ///< from 0 on: the arm is its own mirror image
};

/// State feedback u = K (x_d - x) of the arm with rigid joints, by payload and elbow angle.
///
/// Bilinear between knots, constant beyond the outermost ones. Real-time: At is safe.
class GainTable {
 public:
  /// 2 x 12: N m for what is missing in x = [q; q'] of RigidJointArm.
  using Gain = Eigen::Matrix<double, 2, 12>;

  /// @param knots  row by row: all elbow angles of the first payload, then of the second
  /// @throws std::invalid_argument if an axis is not ascending or has one knot, or gains are
  /// missing
  GainTable(GainGrid grid, std::vector<Gain> knots);

  /// @param theta2_rad  of either sign
  Gain At(double payload_kg, double theta2_rad) const noexcept;

  const GainGrid& grid() const noexcept { return grid_; }
  const std::vector<Gain>& knots() const noexcept { return knots_; }

 private:
  const Gain& Knot(std::size_t payload, std::size_t theta2) const noexcept {
    return knots_[payload * grid_.theta2_rad.size() + theta2];
  }

  GainGrid grid_;
  std::vector<Gain> knots_;
};

}  // namespace flexarm
