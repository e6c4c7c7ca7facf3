#include "controller/operator/payload_json.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "controller/operator/payload_warnings.h"

namespace flexarm {

nlohmann::json PayloadJson(const StepInput& input, const StepOutput& output) {
  if (std::isnan(output.payload_kg)) return nullptr;
  nlohmann::json warnings = nlohmann::json::array();
  for (const PayloadWarningText& warning : kPayloadWarnings) {
    if ((output.payload_warnings & warning.bit) != 0) warnings.push_back(warning.name);
  }
  return {{"kg", output.payload_kg},
          {"sigma_kg", output.payload_sigma_kg},
          {"friction_nm", output.friction_nm},
          {"mean_nis", output.mean_nis},
          {"delay_found", output.delay_found},
          {"planned", input.planned != 0},
          {"warnings", warnings}};
}

}  // namespace flexarm
