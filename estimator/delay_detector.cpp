#include "estimator/delay_detector.h"

#include <algorithm>
#include <limits>

namespace flexarm {
namespace {

// NaN counts as the largest NIS: a hypothesis whose prediction is NaN explains nothing.
double Bounded(double value) noexcept {
  return value < DelayDetector::kMost ? value : DelayDetector::kMost;
}

}  // namespace

bool DelayDetector::Take(const Misfit& misfit) noexcept {
  const bool explained = std::any_of(misfit.begin(), misfit.end(),
                                     [](const auto& nis) { return nis && *nis < kExplained; });
  if (!explained) return false;
  for (std::size_t d = 0; d < kDelays; ++d) {
    unexplained_[d] = misfit[d] ? kMemory * unexplained_[d] + Bounded(*misfit[d])
                                : std::numeric_limits<double>::infinity();
  }
  if (!(lead() > kBetter)) return false;
  index_ = Best();
  unexplained_.fill(0.0);
  return true;
}

std::size_t DelayDetector::Best() const noexcept {
  return static_cast<std::size_t>(std::min_element(unexplained_.begin(), unexplained_.end()) -
                                  unexplained_.begin());
}

double DelayDetector::lead() const noexcept { return unexplained_[index_] - unexplained_[Best()]; }

}  // namespace flexarm
