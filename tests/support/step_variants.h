#pragma once

#include <array>
#include <string>
#include <vector>

#include "controller/types/law_table.h"

namespace flexarm {

/// A combination of law and estimator for Step: --set of the shipped rig.
struct StepVariant {
  const char* name;
  std::vector<std::string> overrides;
  /// Bound on the instructions of a step: 20 us at a billion instructions a second, with a factor
  /// of three for slower machines; 73 us with payload estimation, on a processor without AVX2.
  int most_instructions = 60'000;
};

/// Every law with the shipped estimator, every estimator with the shipped law, the nominal model
/// with the most states, and the laws that have their own estimator.
inline std::vector<StepVariant> StepVariants() {
  std::vector<StepVariant> variants;
  constexpr int kMostWithPayload = 220'000;
  for (const LawRow& law : kLaws) {
    variants.push_back({law.name, {std::string("controller.name=") + law.name}});
    if (law.is_scheduled || law.settles) variants.back().most_instructions = kMostWithPayload;
  }
  for (const char* estimator : {"difference", "polynomial"}) {
    variants.push_back({estimator, {std::string("estimator.name=") + estimator}});
  }
  variants.push_back({"T16", {"controller.nominal=T16"}});
  variants.push_back({"ekf-payload", {"estimator.name=ekf-payload"}, kMostWithPayload});
  // With a declared delay of a sample, one sample less is a hypothesis too.
  variants.push_back({"gain-scheduled-late",
                      {"controller.name=gain-scheduled", "loop.actuation_delay_ms=20"},
                      kMostWithPayload});
  return variants;
}

}  // namespace flexarm
