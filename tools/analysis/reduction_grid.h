#pragma once

#include <array>
#include <functional>
#include <vector>

#include "model/reduction/arm_reduction.h"

namespace flexarm {

/// Options of `analyze reduce` for one nominal motion, or for any linear system.
struct ReductionOptions {
  ModalScaling scaling = ModalScaling::kMass;
  double rigid_below_rad2_s2 = PowerOptions{}.rigid_below_rad2_s2;
  double margin_per_s = 1e-2;  ///< a stable mode decays faster; the truncation keeps the others
};

/// The space of nominal motions of thesis 6.5.2, divided into equal cells.
///
/// Defaults are the thesis's: the elbow from 0 to 90 degrees, 4 and 6 rad/s, 20 intervals each.
struct ReductionGrid {
  std::array<double, 2> theta2_deg = {0.0, 90.0};
  double theta1_rate_rad_s = 4.0,
         theta2_rate_rad_s = 6.0;  ///< the range is from minus this value to plus this value
  int cells = 20;                  ///< intervals in each direction

  /// Motion at the centre of interval i, j, k of th2, th1', th2'.
  NominalMotion Centre(int i, int j, int k) const;
};

/// Results of one cell.
struct ReductionCell {
  NominalMotion motion;
  std::array<double, 2> epsilon_1_percent, epsilon_2_percent;  ///< of link 1, link 2
  double
      rigid_share_percent;  ///< share of the sum of rho of a rigid-body root that became positive
  int zero_roots;           ///< number of roots left out as rigid-body motions
  int negative_roots;       ///< number of roots left out as negative or complex
};

/// Power balancing at one nominal motion.
ReductionCell ReduceCell(const ArmModel& model, const NominalMotion& motion,
                         const ReductionOptions& options = {});

/// ReduceCell for all motions, on all cores; results in the order of the motions.
/// @param progress  as ParallelFor
std::vector<ReductionCell> ReduceCells(const ArmModel& model,
                                       const std::vector<NominalMotion>& motions,
                                       const ReductionOptions& options,
                                       const std::function<void(std::size_t)>& progress = {});

/// All centres of a grid; th2' varies fastest, then th1', then th2.
std::vector<NominalMotion> CentresOf(const ReductionGrid& grid);

}  // namespace flexarm
