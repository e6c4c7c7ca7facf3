#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "model/arm/arm_model.h"
#include "model/arm/linearization.h"

namespace flexarm {

/// Two outputs of the arm, and the invariant zeros of the way to them from the motors' torques.
struct OutputZeros {
  std::string name;        ///< "rotors", "hubs", "link_ends", "tip"
  bool defined;            ///< false: the torques cannot move both outputs, so there is no zero
  Eigen::VectorXcd zeros;  ///< 1/s, by their distance from 0

  /// Zeros in the right half plane, beyond round-off: none is minimum phase.
  int unstable() const;
};

/// The outputs of an arm that is linearised at q and v:
///   rotors     th3, th4, which the torques turn
///   hubs       th1, th2
///   link_ends  the direction of each link's end as seen from its root, th_i + w_i(L_i)/L_i
///   tip        the tip in the base frame; undefined with the elbow straight
std::vector<OutputZeros> ArmZeros(const ArmModel& model, const LinearModel& linear,
                                  const Eigen::VectorXd& q);

}  // namespace flexarm
