#include "tools/thesis/rig_needs.h"

namespace flexarm {

std::string LacksTwoModes(const RigConfig& config) {
  if (config.estimator.modes_per_link >= 2) return "";
  return "the model has two modes a link, its gauges measure one (estimator.modes_per_link)";
}

std::string LacksR12(const RigConfig& config) {
  if (config.controller.nominal == kR12) return LacksTwoModes(config);
  return "its nominal model is another (controller.nominal)";
}

}  // namespace flexarm
