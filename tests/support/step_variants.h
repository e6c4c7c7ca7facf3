#pragma once

#include <array>
#include <string>
#include <vector>

#include "controller/types/law_table.h"

namespace flexarm {

/// A law and an estimator that Step can be made of: --set of the shipped rig.
struct StepVariant {
  const char* name;
  std::vector<std::string> overrides;
  /// A step may take no more: 20 us at a billion instructions a second, with three times that for
  /// slower machines; of what finds the payload, 150 us.
  int most_instructions = 60'000;
};

/// Every law with the shipped estimator, every estimator with the shipped law, the nominal model
/// with the most states, and the laws that bring their estimator along.
inline std::vector<StepVariant> StepVariants() {
  std::vector<StepVariant> variants;
  constexpr int kMostWithPayload = 450'000;
  for (const LawRow& law : kLaws) {
    variants.push_back({law.name, {std::string("controller.name=") + law.name}});
    if (law.is_scheduled) variants.back().most_instructions = kMostWithPayload;
  }
  for (const char* estimator : {"difference", "polynomial"}) {
    variants.push_back({estimator, {std::string("estimator.name=") + estimator}});
  }
  variants.push_back({"T16", {"controller.nominal=T16"}});
  variants.push_back({"ekf-payload", {"estimator.name=ekf-payload"}, kMostWithPayload});
  // With a sample of delay declared, one less is possible as well.
  variants.push_back({"gain-scheduled-late",
                      {"controller.name=gain-scheduled", "loop.actuation_delay_ms=20"},
                      kMostWithPayload});
  return variants;
}

}  // namespace flexarm
