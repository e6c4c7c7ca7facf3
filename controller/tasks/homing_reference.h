#pragma once

#include <array>
#include <cstddef>

#include "controller/types/step_types.h"
#include "hal/sensor_frame.h"

namespace flexarm {

/// A slow, bounded search for a limit switch by one joint; the other holds its place.
struct HomingPlan {
  Line line;          ///< the switch
  std::size_t joint;  ///< 0 or 1
  double step_rad;    ///< of the goal each period; its sign is the direction of the search
  double travel_rad;  ///< searched at most, > 0
  double back_rad;    ///< off the switch afterwards, > 0
};

/// The goal of a homing run, sample by sample: towards the switch until it opens, then back off it
/// by `back_rad` of where it opened, then done. A switch that does not open within `travel_rad`
/// ends the search where it is. Real-time: safe.
class HomingReference {
 public:
  /// @param hub_rad  where the hubs are
  void Start(const HomingPlan& plan, const std::array<double, 2>& hub_rad) noexcept;

  /// The next period's goal, in x_m. @param levels  of the digital inputs
  ReferenceSample Next(LineLevels levels, const std::array<double, 2>& hub_rad) noexcept;

  bool ended() const noexcept { return ended_; }

 private:
  HomingPlan plan_{};
  std::array<double, 2> goal_rad_{};
  double left_rad_ = 0.0;  // of the search, or of the way back
  bool found_ = false;
  bool ended_ = true;
};

}  // namespace flexarm
