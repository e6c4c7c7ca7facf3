#include "tools/thesis/rig_needs.h"

#include <array>
#include <cmath>

#include "tools/analysis/statement.h"

namespace flexarm {

std::string LacksThesisLinks(const ArmParameters& arm) {
  constexpr std::array<double, 2> kTable2_m = {0.8, 0.9};
  for (std::size_t i = 0; i < kTable2_m.size(); ++i) {
    const double length_m = arm.link[i].length_m();
    if (std::abs(length_m - kTable2_m[i]) < 1e-6) continue;
    return "its link " + Count(static_cast<std::ptrdiff_t>(i) + 1) + " is " + Figure(length_m) +
           " m long, Table 2 has " + Figure(kTable2_m[i], 1) + " m";
  }
  return "";
}

std::string LacksTwoModes(const RigConfig& config) {
  if (config.estimator.modes_per_link >= 2) return "";
  return "the model has two modes a link, its gauges measure one (estimator.modes_per_link)";
}

std::string LacksR12(const RigConfig& config) {
  if (config.controller.nominal == kR12) return LacksTwoModes(config);
  return "its nominal model is another (controller.nominal)";
}

}  // namespace flexarm
