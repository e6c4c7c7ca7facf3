#include "controller/law/scheduling_payload.h"

#include <algorithm>

namespace flexarm {
namespace {

// Shares of the greatest payload.
constexpr double kStableForAll = 0.15, kUncertain = 0.1;
constexpr double kRested_s = 2.0;
constexpr double kNisDoubtful = 20.0;  // 8 expected

}  // namespace

double SchedulingPayload(double payload_kg, double payload_sigma_kg, double mean_nis,
                         double rested_s, double most_kg) noexcept {
  const double robust_kg = std::min(payload_kg, kStableForAll * most_kg);
  if (rested_s > kRested_s) return robust_kg;
  const double sigmas = payload_sigma_kg / (kUncertain * most_kg);
  const double uncertain = std::min(sigmas * sigmas, 1.0);
  const double wrong =
      std::clamp((mean_nis - kNisDoubtful) / (kModelWrongNis - kNisDoubtful), 0.0, 1.0);
  const double w = std::max(uncertain, wrong);
  return (1.0 - w) * payload_kg + w * robust_kg;
}

}  // namespace flexarm
