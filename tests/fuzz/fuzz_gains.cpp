#include <nlohmann/json.hpp>
#include <string>

#include "controller/design/design_json.h"
#include "controller/files/nesting.h"
#include "controller/types/rejected_error.h"
#include "tests/controller/law/shipped_rig.h"
#include "tests/fuzz/fuzz_targets.h"

namespace flexarm {
namespace {

// A gains file has 90 kB: too long to be changed blindly. So an input may be a JSON patch
// (RFC 6902) of a good one.
std::string GainsOf(const std::string& input, const nlohmann::json& good) {
  if (!input.starts_with("[{") || LineNestedTooDeepJson(input) != 0) return input;
  try {
    return good.patch(nlohmann::json::parse(input)).dump();
  } catch (const nlohmann::json::exception&) {
    return input;
  }
}

}  // namespace

void FuzzGains(FuzzBytes input) {
  static const RigConfig config = ShippedRig();
  static const nlohmann::json good =
      nlohmann::json::parse(DesignToJson(ShippedDesign(), DesignHash(config)));
  try {
    Design design = DesignFromJson(GainsOf(TextOf(input), good), config);
  } catch (const RejectedError&) {
  }
}

}  // namespace flexarm
