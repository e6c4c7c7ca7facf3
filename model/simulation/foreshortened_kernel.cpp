#include <algorithm>
#include <stdexcept>

#include "model/simulation/fixed_kernel.h"
#include "model/simulation/foreshortened_arm.h"
#include "model/simulation/step_kernel.h"

namespace flexarm {

// Three sizes serve all counts: each costs ten seconds of compile time, a padded mode almost no
// run time.
std::unique_ptr<StepKernel> MakeForeshortenedKernel(const ArmConstants& c, bool coulomb_friction) {
  switch (std::max(c.m1, c.m2)) {
    case 1:
    case 2:
      return std::make_unique<FixedKernel<ForeshortenedArm<2>>>(c, coulomb_friction);
    case 3:
    case 4:
      return std::make_unique<FixedKernel<ForeshortenedArm<4>>>(c, coulomb_friction);
    case 5:
    case 6:
      return std::make_unique<FixedKernel<ForeshortenedArm<6>>>(c, coulomb_friction);
    default:
      throw std::invalid_argument("MakeForeshortenedKernel: 1 to 6 modes per link");
  }
}

}  // namespace flexarm
