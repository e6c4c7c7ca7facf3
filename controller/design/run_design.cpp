#include "controller/design/run_design.h"

#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

#include "controller/design/design_controller.h"
#include "controller/design/design_json.h"
#include "controller/design/design_verdict.h"
#include "controller/types/rejected_error.h"

namespace flexarm {
namespace {

Design ReadDesign(const ControlConfig& config) {
  const std::string& name = config.controller.gains_file;
  std::ifstream file(name);
  if (!file) {
    throw RejectedError(name +
                        ": cannot be read (controller.gains); create it with `flexarm design`");
  }
  std::stringstream text;
  text << file.rdbuf();
  try {
    return DesignFromJson(text.str(), config);
  } catch (const RejectedError& error) {
    throw RejectedError(name + ": " + error.what());
  }
}

Design NewDesign(const ControlConfig& config) {
  try {
    return DesignController(config);
  } catch (const std::runtime_error& error) {
    throw RejectedError(std::string("no controller can be designed for this config: ") +
                        error.what());
  }
}

}  // namespace

Design DesignFor(const ControlConfig& config) {
  Design design = config.controller.gains_file.empty() ? NewDesign(config) : ReadDesign(config);
  for (const DesignCheck& check : design.checks) {
    if (check.passed() || check.waived) continue;
    throw RejectedError("a check of the design failed: " + CheckText(check));
  }
  return design;
}

}  // namespace flexarm
