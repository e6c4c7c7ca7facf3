#include <algorithm>
#include <cstddef>

#include "tools/torture/torture.h"

namespace flexarm {
namespace {

bool Breaks(const TorturedRigs& rigs, const TortureScenario& scenario, const std::string& rule,
            const Peaks& envelope) {
  const TortureOutcome outcome = RunScenario(rigs, scenario, envelope);
  return std::any_of(outcome.violations.begin(), outcome.violations.end(),
                     [&rule](const Violation& one) { return one.rule == rule; });
}

}  // namespace

TortureScenario Minimised(const TorturedRigs& rigs, const TortureScenario& scenario,
                          const std::string& rule, const Peaks& envelope) {
  TortureScenario best = scenario;
  const auto attempt = [&](const TortureScenario& smaller) {
    if (!Breaks(rigs, smaller, rule, envelope)) return false;
    best = smaller;
    return true;
  };
  const auto without = [&](auto member) {
    for (std::size_t i = 0; i < (best.*member).size();) {
      TortureScenario smaller = best;
      (smaller.*member).erase((smaller.*member).begin() + static_cast<std::ptrdiff_t>(i));
      if (!attempt(smaller)) ++i;
    }
  };
  without(&TortureScenario::faults);
  without(&TortureScenario::commands);
  without(&TortureScenario::plant);
  TortureScenario calm = best;
  calm.wake_ups = {};
  attempt(calm);
  TortureScenario no_way_back = best;
  no_way_back.recovers = false;
  attempt(no_way_back);
  // The shortest run: each time is halved while the rule is still broken.
  const auto halve = [&](auto time_ns) {
    for (;;) {
      TortureScenario shorter = best;
      std::int64_t& ns = time_ns(&shorter);
      if (ns == INT64_MAX || ns / 2 < kMs) return;
      ns = ns / (2 * kMs) * kMs;
      if (!attempt(shorter)) return;
    }
  };
  halve([](TortureScenario* one) -> std::int64_t& { return one->after_ns; });
  for (std::size_t i = 0; i < best.faults.size(); ++i) {
    halve([i](TortureScenario* one) -> std::int64_t& { return one->faults[i].from_ns; });
    halve([i](TortureScenario* one) -> std::int64_t& { return one->faults[i].to_ns; });
  }
  return best;
}

}  // namespace flexarm
