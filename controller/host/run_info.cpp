#include "controller/host/run_info.h"

#include "controller/design/design_json.h"
#include "controller/types/law_table.h"

namespace flexarm {

RunInfo MakeRunInfo(const RigConfig& config, const Design& design, const std::string& clock,
                    const std::string& backend) {
  RunInfo info;
  info.rig_name = config.rig_name;
  info.clock = clock;
  info.backend = backend;
  info.seed = config.sim.seed;
  info.config_text = config.text;
  info.gains_json = DesignToJson(design, DesignHash(config));
  info.law = LawOf(config.controller.kind).name;
  if (backend == "sim") info.payload_kg = config.arm.payload_mass_kg;
  return info;
}

}  // namespace flexarm
