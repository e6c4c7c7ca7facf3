#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "config/plausibility/plausibility_rules.h"
#include "estimator/nominal_model.h"
#include "hal/sensor_config.h"
#include "model/arm/arm_model.h"
#include "model/problem_list.h"
#include "model/units.h"

namespace flexarm {
namespace {

/// What one gauge reads of the fitted modes of its link, strain per metre of their largest
/// deflection. Not of the tip's, at which a link with a heavy tip has a node of its second mode.
struct GaugeShape {
  std::size_t row;               ///< in sensors.strain
  std::vector<double> by_modes;  ///< 1/m
};

double LargestDeflection(const BeamMode& mode) {
  constexpr int kPlaces = 20;
  double largest = 0.0;
  for (int i = 1; i <= kPlaces; ++i) {
    largest = std::max(largest, std::abs(mode.Value(mode.length_m() * i / kPlaces)));
  }
  return largest;
}

std::vector<GaugeShape> GaugeShapes(const ControlConfig& config, int link) {
  const int modes = config.estimator.modes_per_link;
  const ArmModel model(config.arm, {modes, modes});
  std::vector<GaugeShape> shapes;
  for (std::size_t row = 0; row < config.sensors.strain.size(); ++row) {
    const StrainChannelConfig& gauge = config.sensors.strain[row];
    if (gauge.link != link) continue;
    GaugeShape shape{.row = row, .by_modes = {}};
    for (int mode = 0; mode < modes; ++mode) {
      const int coordinate = 4 + (link - 1) * modes + mode;
      const Eigen::VectorXd q = Eigen::VectorXd::Unit(model.dof(), coordinate);
      const BeamMode& of_mode = model.link_modes(link).mode[static_cast<std::size_t>(mode)];
      shape.by_modes.push_back(model.Strain(link, gauge.position_m, q) /
                               LargestDeflection(of_mode));
    }
    shapes.push_back(shape);
  }
  return shapes;
}

// Converter counts of the gauge for the deflection, in the fitted mode that it sees best.
double CountsAt(const ControlConfig& config, const GaugeShape& shape, double deflection_m) {
  double strain = 0.0;
  for (const double by_mode : shape.by_modes)
    strain = std::max(strain, std::abs(by_mode) * deflection_m);
  const double gain = std::abs(config.sensors.strain[shape.row].gain_v_per_unit);
  return strain * gain / config.sensors.strain_input.volts_per_count();
}

// Condition number of the fit of two modes, each of them scaled to length 1: sqrt((1 + r)/(1 - r))
// with r the cosine of their columns. 1 for one mode.
double FitCondition(const ControlConfig& config, const std::vector<GaugeShape>& shapes) {
  double aa = 0.0, ab = 0.0, bb = 0.0;
  for (const GaugeShape& shape : shapes) {
    if (shape.by_modes.size() < 2) return 1.0;
    const double gain = config.sensors.strain[shape.row].gain_v_per_unit;
    const double a = gain * shape.by_modes[0], b = gain * shape.by_modes[1];
    aa += a * a;
    ab += a * b;
    bb += b * b;
  }
  const double r = std::min(1.0, std::abs(ab) / std::sqrt(aa * bb));
  return r < 1.0 ? std::sqrt((1.0 + r) / (1.0 - r)) : std::numeric_limits<double>::infinity();
}

}  // namespace

ImplausibleValueList JudgeEncoders(const ControlConfig& config) {
  constexpr double kShare = 0.01;  // of the reach
  const double length1 = config.arm.link[0].length_m(), length2 = config.arm.link[1].length_m();
  const double reach_m = length1 + length2;
  ImplausibleValueList found;
  for (std::size_t i = 0; i < config.sensors.encoder.size(); ++i) {
    const EncoderConfig& encoder = config.sensors.encoder[i];
    const double lever_m = encoder.counter % 2 == 0 ? reach_m : length2;  // hub1 hub2 rotor1 rotor2
    const double step_m = kTwoPi / encoder.counts_per_turn * lever_m;
    if (step_m <= kShare * reach_m) continue;
    found.push_back({ProblemList::Element("sensors.encoder", i) + ".counts_per_turn",
                     NumberText(encoder.counts_per_turn),
                     "one count of " + std::string(CounterName(encoder.counter)) +
                         " moves the tip by " + ShortNumber(1e3 * step_m) + " mm, " +
                         ShortNumber(100.0 * step_m / reach_m) + " % of the reach",
                     "above " + ShortNumber(std::ceil(kTwoPi * lever_m / (kShare * reach_m))) +
                         " counts per turn of the joint, gear and quadrature included"});
  }
  return found;
}

ImplausibleValueList JudgeGaugeSignals(const ControlConfig& config) {
  constexpr double kShare = 0.01;  // of the link's length: a visible deflection
  constexpr double kFewest = 2.0;  // counts for it
  ImplausibleValueList found;
  for (int link = 1; link <= 2; ++link) {
    const double deflection_m =
        kShare * config.arm.link[static_cast<std::size_t>(link) - 1].length_m();
    for (const GaugeShape& shape : GaugeShapes(config, link)) {
      const double counts = CountsAt(config, shape, deflection_m);
      if (counts >= kFewest) continue;
      const double gain = config.sensors.strain[shape.row].gain_v_per_unit;
      found.push_back({ProblemList::Element("sensors.strain", shape.row) + ".gain_v_per_unit",
                       NumberText(gain),
                       "a deflection of 1 % of the link, " + ShortNumber(1e3 * deflection_m) +
                           " mm, changes the gauge by " + ShortNumber(counts) + " counts",
                       "2 counts or more: volts per unit strain of bridge and amplifier together, "
                       "often 1000 to 10000; sensors.strain_input has the converter"});
    }
  }
  return found;
}

ImplausibleValueList JudgeGaugePlaces(const ControlConfig& config) {
  constexpr double kWorst = 20.0;
  ImplausibleValueList found;
  for (int link = 1; link <= 2; ++link) {
    const std::vector<GaugeShape> shapes = GaugeShapes(config, link);
    if (shapes.empty()) continue;
    const double condition = FitCondition(config, shapes);
    if (condition <= kWorst) continue;
    const std::size_t row = shapes.back().row;
    found.push_back({ProblemList::Element("sensors.strain", row) + ".position_m",
                     NumberText(config.sensors.strain[row].position_m),
                     "the gauges of link " + NumberText(link) +
                         " read almost the same mixture of both modes: condition number " +
                         ShortNumber(condition) + " of the fit",
                     "below 20: gauges further apart (`flexarm gauges` finds places), or "
                     "estimator.modes_per_link = 1"});
  }
  return found;
}

ImplausibleValueList JudgeSamplingRate(const ControlConfig& config) {
  const NominalModel nominal = MakeNominalModel(config.arm, config.controller.nominal);
  const double nyquist_hz = 0.5 / config.loop.period_s();
  const Eigen::VectorXd frequency_hz = nominal.torque_mode_rad_s / kTwoPi;
  const auto above = (frequency_hz.array() > nyquist_hz).count();
  if (above == 0) return {};
  const double highest_hz = frequency_hz.maxCoeff();
  return {{"loop.period_ms", NumberText(config.loop.period_ms),
           NumberText(above) + " of the " + NumberText(frequency_hz.size()) +
               " modes of the nominal model " + std::string(NameOf(config.controller.nominal)) +
               " lie above half the sampling rate, " + ShortNumber(nyquist_hz) + " Hz: up to " +
               ShortNumber(highest_hz) + " Hz",
           "a period below " + ShortNumber(500.0 / highest_hz) +
               " ms, or a controller.nominal with fewer modes"}};
}

}  // namespace flexarm
