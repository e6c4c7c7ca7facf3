#include "estimator/unfitted_mode.h"

#include <cstddef>

#include "model/beam/link_modes.h"

namespace flexarm {

std::array<double, 2> SecondModeInFirst(const ArmParameters& arm, const SensorConfig& sensors) {
  const std::array<LinkModes, 2> modes = {Link1Modes(arm, 2), Link2Modes(arm, 2)};
  std::array<double, 2> across{}, first{};
  for (const StrainChannelConfig& gauge : sensors.strain) {
    const auto link = static_cast<std::size_t>(gauge.link - 1);
    // A channel's weight is its gain squared, as all have the same noise in volts.
    const double surface =
        gauge.gain_v_per_unit * arm.link[link].HalfThicknessAt_m(gauge.position_m);
    const double one = surface * modes[link].mode[0].Curvature(gauge.position_m);
    const double two = surface * modes[link].mode[1].Curvature(gauge.position_m);
    across[link] += one * two;
    first[link] += one * one;
  }
  for (std::size_t link = 0; link < 2; ++link) across[link] /= first[link];
  return across;
}

}  // namespace flexarm
