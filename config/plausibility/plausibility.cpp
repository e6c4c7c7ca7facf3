#include "config/plausibility/plausibility.h"

#include <array>
#include <iterator>

#include "config/plausibility/plausibility_rules.h"

namespace flexarm {

std::vector<ImplausibleValue> ImplausibleValues(const RigConfig& config) {
  constexpr std::array kRules = {JudgeLinkLengths,     JudgeMaterials,      JudgeThickness,
                                 JudgeDamping,         JudgeJointTwist,     JudgeEncoders,
                                 JudgeGaugeSignals,    JudgeGaugePlaces,    JudgeSamplingRate,
                                 JudgeFrictionTorques, JudgeBendingTorques, JudgeStrainLimits};
  std::vector<ImplausibleValue> all;
  for (const auto rule : kRules) {
    std::vector<ImplausibleValue> found = rule(config);
    all.insert(all.end(), std::move_iterator(found.begin()), std::move_iterator(found.end()));
  }
  return all;
}

}  // namespace flexarm
