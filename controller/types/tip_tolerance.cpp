#include "controller/types/tip_tolerance.h"

#include <algorithm>

#include "controller/types/control_config.h"
#include "model/units.h"

namespace flexarm {

double Reach_m(const ControlConfig& config) {
  return config.arm.link[0].length_m() + config.arm.link[1].length_m();
}

double CountAtTip_m(const ControlConfig& config) {
  constexpr int kHubs = 2;  // counters below this are the hubs'
  double count_rad = 0.0;
  for (const EncoderConfig& encoder : config.sensors.encoder) {
    if (encoder.counter < kHubs) count_rad = std::max(count_rad, kTwoPi / encoder.counts_per_turn);
  }
  return count_rad * Reach_m(config);
}

double SettledWithin_m(const ControlConfig& config) {
  return std::min(kLargestTipError_m,
                  kLargestTipErrorOfReach * Reach_m(config) + CountAtTip_m(config));
}

}  // namespace flexarm
