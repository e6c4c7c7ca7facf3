#include "controller/law/scheduled_law.h"

#include <algorithm>
#include <cstddef>
#include <limits>

#include "controller/law/scheduling_payload.h"
#include "model/math/portable_math.h"

namespace flexarm {
namespace {

// Below this rate the friction feedforward is faded out: at the ends of a move the sign of the
// friction is uncertain.
constexpr double kFrictionRate_rad_s = 0.05;

// Friction compensation of the feedback after a move. The feedback torque is then smaller than the
// friction: the joints stick, and the links would vibrate undamped as if their roots were clamped.
// The compensation adds the whole friction, with the scale of a tenth of it for the feedback
// torque: breakaway pulses with the sign of the feedback. It is faded out over 4 s, so that encoder
// quantisation in the feedback does not move an arm at rest, and not given while the payload is
// unknown: the friction then holds an arm whose load has changed, which wrong gains would move.
constexpr double kFeedbackScale = 0.1, kCompensationFades_s = 4.0;
// Standard deviation as a share of the greatest payload; after an announced change it is 0.27.
constexpr double kUnknownPayload = 0.2;

}  // namespace

LawOutput ScheduledLaw::Compute(const LawInput& input) noexcept {
  const MotionSample desired =
      input.plan == nullptr ? ClosedForm(input.payload.payload_kg, *input.path) : *input.plan;
  return SaturateWithoutAdaptation(Torque(*input.x, input.payload, desired, input.rested_s),
                                   torque_limit_nm_);
}

Eigen::Vector2d ScheduledLaw::Torque(const State& x, const PayloadKnowledge& knowledge,
                                     const MotionSample& desired, double rested_s) const noexcept {
  const State x_desired = desired.State();
  Eigen::Vector2d u = desired.Torque_nm();
  for (int i = 0; i < 2; ++i) {
    const double rate_rad_s = x_desired[RigidJointArm::kDof + i];
    u[i] += knowledge.friction_nm[static_cast<std::size_t>(i)] *
            PortableMath::Tanh(rate_rad_s / kFrictionRate_rad_s);
  }
  const bool at_bound = (knowledge.warnings & kPayloadAtBound) != 0;
  const double sigma_kg =
      at_bound ? std::numeric_limits<double>::infinity() : knowledge.payload_sigma_kg;
  const double gain_payload_kg = SchedulingPayload(knowledge.payload_kg, sigma_kg,
                                                   knowledge.mean_nis, rested_s, payload_max_kg_);
  Eigen::Vector2d feedback_nm = gains_.At(gain_payload_kg, x[1]).lazyProduct(x_desired - x);
  guard_.Limit(x, &u, &feedback_nm);
  u += feedback_nm;
  const bool unknown = knowledge.payload_sigma_kg > kUnknownPayload * payload_max_kg_;
  const double share =
      rested_s > 0.0 && !unknown ? std::max(0.0, 1.0 - rested_s / kCompensationFades_s) : 0.0;
  for (int i = 0; i < 2; ++i) {
    const double friction_nm = knowledge.friction_nm[static_cast<std::size_t>(i)];
    if (share == 0.0 || friction_nm <= 0.0) continue;
    u[i] +=
        share * friction_nm * PortableMath::Tanh(feedback_nm[i] / (kFeedbackScale * friction_nm));
  }
  return u;
}

}  // namespace flexarm
