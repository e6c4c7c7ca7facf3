#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <string>

#include "tests/support/sanitizer.h"

namespace flexarm {

/// How many cases a campaign of random cases has: `sample` in every run of the tests, a tenth of
/// that under a sanitizer, `whole` with FLEXARM_CAMPAIGN=whole (lane `campaigns`), and N with
/// FLEXARM_CAMPAIGN=N.
inline long CampaignCases(long sample, long whole) {
  const char* wanted = std::getenv("FLEXARM_CAMPAIGN");
  if (wanted != nullptr) return std::string(wanted) == "whole" ? whole : std::atol(wanted);
  return kSanitized ? sample / 10 : sample;
}

/// Threads of a campaign whose cases are independent: FLEXARM_CAMPAIGN_JOBS, or one, because ctest
/// runs several programs at a time.
inline std::size_t CampaignJobs() {
  const char* wanted = std::getenv("FLEXARM_CAMPAIGN_JOBS");
  return wanted == nullptr ? 1 : std::max(std::strtoul(wanted, nullptr, 10), 1UL);
}

}  // namespace flexarm
