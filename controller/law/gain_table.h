#pragma once

#include <Eigen/Core>
#include <vector>

namespace flexarm {

/// Knots of a gain table: ascending, at least two on each axis.
struct GainGrid {
  std::vector<double> payload_kg;
  std::vector<double> theta2_rad;  ///< from 0 on: gains depend on |theta2| by symmetry
};

/// Gains of the state feedback u = K (x_d - x), scheduled by payload and elbow angle, for the arm
/// with rigid joints.
///
/// Bilinear between knots, constant beyond the outermost ones. Real-time: At is safe.
class GainTable {
 public:
  /// 2 x 12: N m per SI unit of the error x_d - x, x = [q; q'] of RigidJointArm.
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
