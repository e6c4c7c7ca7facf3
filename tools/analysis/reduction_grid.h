#pragma once

#include <array>
#include <functional>
#include <vector>

#include "model/reduction/arm_reduction.h"

namespace flexarm {

/// What `analyze reduce` is asked about one nominal motion, or about any system.
struct ReductionOptions {
  ModalScaling scaling = ModalScaling::kMass;
  double rigid_below_rad2_s2 = PowerOptions{}.rigid_below_rad2_s2;
  double margin_per_s = 1e-2;  ///< a stable mode decays faster; the others are kept whole
};

/// The space of nominal motions of thesis 6.5.2, cut into equal cells.
///
/// Defaults are the thesis's: the elbow from 0 to 90 degrees, 4 and 6 rad/s, 20 intervals each.
struct ReductionGrid {
  std::array<double, 2> theta2_deg = {0.0, 90.0};
  double theta1_rate_rad_s = 4.0, theta2_rate_rad_s = 6.0;  ///< from minus this to plus this
  int cells = 20;                                           ///< intervals in each direction

  /// Motion at the centre of interval i, j, k of th2, th1', th2'.
  NominalMotion Centre(int i, int j, int k) const;
};

/// What is kept of one cell.
struct ReductionCell {
  NominalMotion motion;
  std::array<double, 2> epsilon_1_percent, epsilon_2_percent;  ///< of link 1, link 2
  double rigid_share_percent;  ///< of the sum of rho, of a rigid-body root that turned positive
  int zero_roots;              ///< dropped: rigid-body motions
  int negative_roots;          ///< dropped: negative or complex
};

/// One cell.
ReductionCell ReduceCell(const ArmModel& model, const NominalMotion& motion,
                         const ReductionOptions& options = {});

/// All motions, on all cores, in their order.
/// @param progress  as ParallelFor
std::vector<ReductionCell> ReduceCells(const ArmModel& model,
                                       const std::vector<NominalMotion>& motions,
                                       const ReductionOptions& options,
                                       const std::function<void(std::size_t)>& progress = {});

/// All centres of a grid; th2' runs fastest, then th1', then th2.
std::vector<NominalMotion> CentresOf(const ReductionGrid& grid);

}  // namespace flexarm
