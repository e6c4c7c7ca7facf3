#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "config/config.h"
#include "controller/runlog/csv_import.h"
#include "estimator/calibration.h"

namespace flexarm {

using Signal = std::vector<double>;  ///< by sample

/// Angles of the joints of a run, from the rotor's counter where there is one, else the hub's.
struct JointMotion {
  std::array<Signal, 2> angle_rad;
  std::vector<bool> read;  ///< every counter was
};

/// Decodes the counters of all samples. @param calibration  of the run
JointMotion MotionOf(const RigConfig& config, const Calibration& calibration, const CsvRun& run);

/// The moment at the root of a link by torque and motion of its joint, N m.
struct RootMoment {
  Signal moment_nm;
  std::vector<bool> known;  ///< the joint moves, so its friction is known, and was read around it
  double noise_nm;          ///< of the smoothed moment: friction, and counts in the acceleration
};

/// M = u - F sgn(th') - b th' - (J + I_h) th'', whatever the payload and the elbow's angle.
/// @param joint  0 or 1
RootMoment RootMomentOf(std::size_t joint, const RigConfig& config, const CsvRun& run,
                        const JointMotion& motion);

/// Modal coordinates of both links, m, f11 .. f2m, if the joints move as measured: whatever the
/// torques and the friction, but for one payload, and a straight elbow.
std::vector<Eigen::VectorXd> BaseDrivenModes(const RigConfig& config, double payload_kg,
                                             const JointMotion& motion);

/// What the converter reads of a signal behind the gauges' analogue filter.
Signal BehindGaugeFilter(const Signal& signal, const StrainInputConfig& input, double period_s);

/// Mean over a window of 0.06 s about each sample; 0 at the ends.
Signal Smoothed(const Signal& signal, double period_s);
/// Samples on either side of a smoothed one.
std::size_t HalfWindow(double period_s);

}  // namespace flexarm
