#include "controller/design/run_design.h"

#include <stdexcept>
#include <string>

#include "controller/design/design_controller.h"
#include "controller/design/design_json.h"
#include "controller/design/design_verdict.h"
#include "controller/design/gains_check.h"
#include "controller/files/external_file.h"
#include "controller/files/external_text.h"
#include "controller/types/rejected_error.h"

namespace flexarm {
namespace {

Design ReadDesign(const ControlConfig& config) {
  const std::string& name = config.controller.gains_file;
  const FileContent content = ReadExternalFile(name, kGainsFile);
  if (content.problem) {
    throw RejectedError(content.problem->Text(name) +
                        " (controller.gains); create it with `flexarm design`");
  }
  try {
    Design design = DesignFromJson(content.text, config);
    CheckGains(config, &design);
    return design;
  } catch (const RejectedError& error) {
    throw RejectedError(Shown(name, kMessageBytes) + ": " + error.what());
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
