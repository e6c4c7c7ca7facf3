#include <algorithm>
#include <cmath>
#include <cstdio>

#include "estimator/nominal_model.h"
#include "estimator/root_strain.h"
#include "model/beam/link_modes.h"
#include "model/units.h"
#include "tools/tuning/tuning_search.h"

namespace flexarm {
namespace {

template <typename... Values>
std::string Text(const char* format, Values... values) {
  std::array<char, 400> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

// Frequencies of the nominal model, motors free, ascending.
std::vector<double> ModelFrequencies_hz(const RigConfig& config) {
  const NominalModel model = MakeNominalModel(config.arm, config.controller.nominal);
  std::vector<double> hz;
  for (const double w : model.torque_mode_rad_s) hz.push_back(w / kTwoPi);
  return hz;
}

void FastModes(const RigConfig& config, const std::vector<double>& hz,
               std::vector<std::string>* found) {
  const double half_rate_hz = 0.5 / config.loop.period_s();
  if (hz.empty() || hz.back() <= half_rate_hz) return;
  found->push_back(Text(
      "a mode of the model at %.3g Hz is above half the sampling rate, %.3g Hz: a period below "
      "%.3g ms reaches it (loop.period_ms)",
      hz.back(), half_rate_hz, 0.5e3 / hz.back()));
}

void SlowFilter(const RigConfig& config, const std::vector<double>& hz,
                std::vector<std::string>* found) {
  const double filter_hz = config.sensors.strain_input.filter_hz;
  if (hz.empty() || !(filter_hz > 0.0) || filter_hz >= hz.front()) return;
  found->push_back(Text(
      "the gauges' filter of %.3g Hz is slower than the first mode, %.3g Hz: a corner above it "
      "and below half the sampling rate (sensors.strain_input.filter_hz)",
      filter_hz, hz.front()));
}

// The least deflection that one count of a gauge or of an encoder means, at the tip.
void CoarseSensors(const RigConfig& config, std::vector<std::string>* found) {
  const double reach_m = config.arm.link[0].length_m() + config.arm.link[1].length_m();
  constexpr double kShare = 0.01;  // of the reach
  for (const StrainChannelConfig& gauge : config.sensors.strain) {
    const auto i = static_cast<std::size_t>(gauge.link - 1);
    const LinkModes modes = i == 0 ? Link1Modes(config.arm, 1) : Link2Modes(config.arm, 1);
    const double strain =
        config.sensors.strain_input.volts_per_count() / std::abs(gauge.gain_v_per_unit);
    const double tip_m = strain / std::abs(RootStrainShape(config.arm.link[i], modes).front());
    if (tip_m < kShare * reach_m) continue;
    found->push_back(
        Text("one count of a gauge of link %d is %.3g mm at the link's end: an amplifier of %.3g "
             "times the gain, or a converter of more bits",
             gauge.link, 1e3 * tip_m, tip_m / (0.1 * kShare * reach_m)));
    break;
  }
  for (const EncoderConfig& encoder : config.sensors.encoder) {
    if (encoder.counter >= 2) continue;
    const double tip_m = kTwoPi / encoder.counts_per_turn * reach_m;
    if (tip_m < kShare * reach_m) continue;
    found->push_back(
        Text("one count of the encoder of %s is %.3g mm at the tip: %.0f counts per "
             "turn would be 1 mm",
             CounterName(encoder.counter), 1e3 * tip_m, encoder.counts_per_turn * 1e3 * tip_m));
  }
}

}  // namespace

std::vector<std::string> ObstaclesOf(const RigConfig& config) {
  std::vector<std::string> found;
  const std::vector<double> hz = ModelFrequencies_hz(config);
  FastModes(config, hz, &found);
  SlowFilter(config, hz, &found);
  CoarseSensors(config, &found);
  if (found.empty()) {
    found.emplace_back(
        "no mode of the model is above half the sampling rate, and filter, gauges and encoders are "
        "fine enough: narrow controller.payload_range_kg, or stiffen the arm");
  }
  return found;
}

}  // namespace flexarm
