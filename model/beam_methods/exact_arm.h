#pragma once

#include <vector>

#include "model/parameters/arm_parameters.h"

namespace flexarm {

/// The whole arm at rest, unbent and undamped, with links of distributed mass: its natural
/// frequencies without assumed modes, to which those of ArmModel converge from above.
///
/// Exact dynamic stiffness of every section, with hubs, rotors, motor 2, springs and payload at
/// their nodes; link 2 moves along itself as a rigid body. The frequencies are found by counting
/// (Wittrick and Williams), which misses none. Backlash is left out.
/// Symbol: as ArmModel.  Real-time: start-up only (searches, allocates, uses libm).
class ExactArm {
 public:
  /// @throws std::invalid_argument if the parameters have Problems().
  ExactArm(const ArmParameters& parameters, double theta2_rad);

  /// Number of frequencies below omega; with free motors the two rigid-body zeros are two of them.
  /// @param motors_held  both rotors (th3, th4) are held
  int CountBelow(double omega_rad_s, bool motors_held) const;

  /// The lowest `count`, Hz, ascending, without rigid-body zeros; good to 1e-9 relative.
  /// @throws RootSearchError if there is no such frequency.
  std::vector<double> FrequenciesHz(int count, bool motors_held) const;

 private:
  double FrequencyHz(int order, bool motors_held) const;

  ArmParameters parameters_;
  double theta2_rad_;
};

}  // namespace flexarm
