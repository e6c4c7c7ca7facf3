#include "controller/law/design.h"

#include <algorithm>

#include "model/rigid_joint/rigid_joint_step.h"

namespace flexarm {

bool Design::sound() const {
  return std::all_of(checks.begin(), checks.end(),
                     [](const DesignCheck& c) { return c.passed() || c.waived; });
}

RigidJointArm MakeRigidJointArm(const Design& design) {
  return RigidJointStepper(design.payload_model).arm();
}

}  // namespace flexarm
