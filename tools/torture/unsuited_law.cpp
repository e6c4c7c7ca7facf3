#include "tools/torture/unsuited_law.h"

#include <array>
#include <cstdio>

#include "tools/sweep/plant_variant.h"

namespace flexarm {

std::string WhyUnsuited(const TorturedRigs& rigs, const TortureSpace& space,
                        const RigConfig& config, const std::string& law) {
  const std::array<double, 2>& payload_kg = space.PayloadsOf(law);
  const auto& [first_deg, second_deg] = space.within_deg;
  for (const PlantVariant& variant : PlantVariants()) {
    for (const double carried_kg : payload_kg) {
      for (const double elbow_deg : {second_deg, -second_deg}) {
        TortureScenario scenario{.law = law,
                                 .payload_kg = carried_kg,
                                 .plant = VariantOverrides(config, variant.name),
                                 .move_to_deg = {first_deg, elbow_deg},
                                 .situation = Situation::kRunning};
        scenario.move_s = MoveTime_s(space, scenario.move_to_deg, payload_kg[1], 1.0);
        const TortureOutcome outcome = RunScenario(rigs, scenario);
        if (outcome.reached && outcome.cause == TripCause::kNone) continue;
        std::array<char, 32> carried{};
        std::snprintf(carried.data(), carried.size(), "%.3g kg", carried_kg);
        const char* const what = outcome.reached ? ToString(outcome.cause) : "it does not run";
        return std::string(what) + " without a fault, with " + carried.data() + " on the plant \"" +
               variant.name + "\"";
      }
    }
  }
  return {};
}

}  // namespace flexarm
