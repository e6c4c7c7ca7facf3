#include "controller/law/scheduled_law.h"

#include <limits>

#include "controller/law/gain_payload.h"
#include "model/portable_math.h"

namespace flexarm {
namespace {

// Below this rate the friction that is fed forward fades away: at the ends of a move its sign is
// a guess.
constexpr double kFrictionRate_rad_s = 0.05;

}  // namespace

Eigen::Vector2d ScheduledLaw::Torque(const State& x, const PayloadKnowledge& knowledge,
                                     const QuasiStaticSample& desired,
                                     double rested_s) const noexcept {
  Eigen::Vector2d u = desired.torque_nm;
  for (int i = 0; i < 2; ++i) {
    const double rate_rad_s = desired.x[RigidJointArm::kDof + i];
    u[i] += knowledge.friction_nm[static_cast<std::size_t>(i)] *
            PortableMath::Tanh(rate_rad_s / kFrictionRate_rad_s);
  }
  const bool at_bound = (knowledge.doubts & kPayloadAtBound) != 0;
  const double sigma_kg =
      at_bound ? std::numeric_limits<double>::infinity() : knowledge.payload_sigma_kg;
  const double gain_payload_kg =
      GainPayload(knowledge.payload_kg, sigma_kg, knowledge.mean_nis, rested_s);
  u += gains_.At(gain_payload_kg, x[1]).lazyProduct(desired.x - x);
  return u;
}

}  // namespace flexarm
