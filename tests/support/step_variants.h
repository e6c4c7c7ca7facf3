#pragma once

#include <array>
#include <string>
#include <vector>

namespace flexarm {

/// A law and an estimator that Step can be made of: --set of the shipped rig.
struct StepVariant {
  const char* name;
  std::vector<std::string> overrides;
};

/// Every law with the shipped estimator, every estimator with the shipped law, and the nominal
/// model with the most states.
inline std::vector<StepVariant> StepVariants() {
  std::vector<StepVariant> variants;
  for (const char* law :
       {"sobel", "sobel-original", "lqr-cgt", "lqr-um", "lqg", "pd", "pd-zv", "pd-zvd"}) {
    variants.push_back({law, {std::string("controller.name=") + law}});
  }
  for (const char* estimator : {"difference", "polynomial"}) {
    variants.push_back({estimator, {std::string("estimator.name=") + estimator}});
  }
  variants.push_back({"T16", {"controller.nominal=T16"}});
  return variants;
}

}  // namespace flexarm
