#pragma once

#include <array>
#include <cstddef>

#include "controller/types/step_types.h"
#include "hal/sensor_frame.h"

namespace flexarm {

/// A slow, bounded search for a limit switch by one joint; the other joint is held.
struct HomingPlan {
  Line line;          ///< the switch
  std::size_t joint;  ///< 0 or 1
  double step_rad;    ///< change of the goal each period; its sign is the direction of search
  double travel_rad;  ///< largest distance of the search, > 0
  double back_rad;    ///< distance moved off the switch afterwards, > 0
};

/// The goal of a homing run, sample by sample: it moves towards the switch until the switch opens,
/// then back by `back_rad` from there, and ends. If the switch does not open within `travel_rad`,
/// the run ends at the last goal. Real-time: safe.
class HomingReference {
 public:
  /// @param hub_rad  hub angles at the start
  void Start(const HomingPlan& plan, const std::array<double, 2>& hub_rad) noexcept;

  /// Goal of the next period, in x_m. @param levels  of the digital inputs
  ReferenceSample Next(LineLevels levels, const std::array<double, 2>& hub_rad) noexcept;

  bool ended() const noexcept { return ended_; }

 private:
  HomingPlan plan_{};
  std::array<double, 2> goal_rad_{};
  double left_rad_ = 0.0;  // rest of the search, or of the motion back
  bool found_ = false;
  bool ended_ = true;
};

}  // namespace flexarm
