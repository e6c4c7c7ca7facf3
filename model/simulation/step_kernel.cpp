#include "model/simulation/step_kernel.h"

#include <algorithm>
#include <stdexcept>

#include "model/simulation/articulated_arm.h"
#include "model/simulation/fixed_kernel.h"

namespace flexarm {
namespace {

template <int M>
std::unique_ptr<StepKernel> MakeArticulated(const ArmConstants& c, bool coulomb_friction) {
  return std::make_unique<FixedKernel<ArticulatedArm<M>>>(c, coulomb_friction);
}

}  // namespace

std::unique_ptr<StepKernel> MakeStepKernel(const ArmConstants& c, bool coulomb_friction) {
  if (c.foreshortening) return MakeForeshortenedKernel(c, coulomb_friction);
  switch (std::max(c.m1, c.m2)) {
    case 1:
      return MakeArticulated<1>(c, coulomb_friction);
    case 2:
      return MakeArticulated<2>(c, coulomb_friction);
    case 3:
      return MakeArticulated<3>(c, coulomb_friction);
    case 4:
      return MakeArticulated<4>(c, coulomb_friction);
    case 5:
      return MakeArticulated<5>(c, coulomb_friction);
    case 6:
      return MakeArticulated<6>(c, coulomb_friction);
    default:
      throw std::invalid_argument("MakeStepKernel: 1 to 6 modes per link");
  }
}

}  // namespace flexarm
