#include "controller/law/bending_guard.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "estimator/nominal_model.h"
#include "estimator/root_strain.h"

namespace flexarm {
namespace {

constexpr double kFeedbackShare = 0.2;  // of the moment at the strain limit, on a straight link
constexpr double kNoFeedback = 0.8;     // of the strain limit, and more
constexpr double kFullFeedforward = 0.75;
constexpr double kLeadPeriods = 0.25;

}  // namespace

BendingGuard::BendingGuard(const ControlConfig& config) : link_{} {
  const ArmParameters& arm = config.arm;
  const std::array<std::array<double, 2>, 2> strain_per_m = RootStrainShapes(arm, 2);
  for (std::size_t i = 0; i < 2; ++i) {
    const double limit = config.safety.strain_limit[i];
    link_[i] = {.strain_per_m = strain_per_m[i],
                .strain_limit = limit,
                .moment_nm = limit * MomentPerStrain_nm(arm.link[i])};
  }
  lead_s_ =
      kLeadPeriods * 2.0 * std::numbers::pi / MakeNominalModel(arm, kR12).torque_mode_rad_s(0);
}

void BendingGuard::Limit(const State& x, Eigen::Vector2d* feedforward_nm,
                         Eigen::Vector2d* feedback_nm) const noexcept {
  for (Eigen::Index i = 0; i < 2; ++i) {
    const Link& link = link_[static_cast<std::size_t>(i)];
    const auto& [first, second] = link.strain_per_m;
    const Eigen::Index mode = 2 + 2 * i, rate = 8 + 2 * i;
    const double strain = first * x[mode] + second * x[mode + 1];
    const double strain_rate = first * x[rate] + second * x[rate + 1];
    const double ahead = (strain + lead_s_ * strain_rate) / link.strain_limit;
    // A torque accelerates the hub and leaves the link behind: to the other side.
    const double further = ahead > 0.0 ? -1.0 : 1.0;
    const double bent = std::fabs(ahead);
    double& feedforward = (*feedforward_nm)[i];
    double& feedback = (*feedback_nm)[i];
    const double room_nm = kFeedbackShare * link.moment_nm;
    const double most_nm = room_nm * std::max(0.0, 1.0 + ahead / kNoFeedback);
    const double least_nm = -room_nm * std::max(0.0, 1.0 - ahead / kNoFeedback);
    feedback = std::clamp(feedback, least_nm, most_nm);
    if (bent > kFullFeedforward && further * (feedforward + feedback) > 0.0) {
      feedforward *= std::max(0.0, (1.0 - bent) / (1.0 - kFullFeedforward));
    }
  }
}

}  // namespace flexarm
