#include "tools/thesis/verdict_rules.h"

#include <algorithm>
#include <cmath>

namespace flexarm {

Verdict VerdictOf(const std::vector<bool>& parts) {
  const auto held = std::count(parts.begin(), parts.end(), true);
  if (held == 0) return Verdict::kDoesNot;
  return static_cast<std::size_t>(held) == parts.size() ? Verdict::kHolds : Verdict::kInPart;
}

bool ClearlyGreater(const OverSeeds& a, const OverSeeds& b, double share) {
  const double least = std::max({share * std::abs(b.median), a.scatter(), b.scatter()});
  return a.median - b.median > least;
}

bool ClearlyWorse(const Outcome& a, const Outcome& b, double share) {
  if (a.completed != b.completed) return b.completed;
  return ClearlyGreater(a.value, b.value, share);
}

Verdict WorseRule(const std::vector<Contrast>& cases, double share) {
  std::vector<bool> parts;
  for (const Contrast& c : cases) parts.push_back(ClearlyWorse(c.first, c.second, share));
  return VerdictOf(parts);
}

Verdict AsGoodRule(const std::vector<Contrast>& cases, double share) {
  std::vector<bool> parts;
  for (const Contrast& c : cases) {
    parts.push_back(c.first.completed && !ClearlyWorse(c.first, c.second, share));
  }
  return VerdictOf(parts);
}

Verdict UnstableRule(const std::vector<std::size_t>& completed, std::size_t runs) {
  std::vector<bool> parts;
  for (const std::size_t done : completed) parts.push_back(done < runs);
  return VerdictOf(parts);
}

Verdict NearRule(const std::vector<double>& best, double from, double to) {
  std::vector<bool> parts;
  for (const double value : best) parts.push_back(value >= from && value <= to);
  return VerdictOf(parts);
}

Verdict BetterInsideRule(const std::vector<std::array<OverSeeds, 3>>& cases) {
  std::vector<bool> parts;
  for (const auto& [low, middle, high] : cases) {
    parts.push_back(ClearlyGreater(low, middle));
    parts.push_back(ClearlyGreater(high, middle));
  }
  return VerdictOf(parts);
}

Verdict DampedRule(const std::vector<RestOutcome>& cases, double within_s) {
  std::vector<bool> parts;
  for (const RestOutcome& rest : cases) {
    parts.push_back(rest.completed && rest.within_15mm_s <= within_s);
    parts.push_back(rest.completed && rest.within_5mm_s <= within_s);
    parts.push_back(rest.completed && rest.last_second_mm <= kRestMotion_mm);
  }
  return VerdictOf(parts);
}

Verdict FinalErrorRule(const std::vector<Outcome>& final_deg, double bound_deg) {
  std::vector<bool> parts;
  for (const Outcome& f : final_deg) {
    parts.push_back(f.completed && f.value.median <= bound_deg);
  }
  return VerdictOf(parts);
}

Verdict BestInMiddleRule(const std::vector<std::array<OverSeeds, 3>>& joints) {
  std::vector<bool> parts;
  for (const auto& [low, middle, high] : joints) {
    parts.push_back(ClearlyGreater(low, middle) && ClearlyGreater(high, middle));
  }
  return VerdictOf(parts);
}

Verdict HeavierRule(const std::vector<std::array<LoadFigures, 2>>& light_then_heavy) {
  std::vector<bool> parts;
  for (const auto& [light, heavy] : light_then_heavy) {
    parts.push_back(heavy.lowest_hz < light.lowest_hz);
    for (std::size_t i = 0; i < 2; ++i) {
      parts.push_back(ClearlyGreater(heavy.torque_nm[i], light.torque_nm[i], 0.0));
      parts.push_back(ClearlyGreater(heavy.bending_mm[i], light.bending_mm[i], 0.0));
    }
  }
  return VerdictOf(parts);
}

bool AsLong(double first_s, double second_s) {
  constexpr double kShare = 0.25, kNear_s = 0.25;
  return std::abs(first_s - second_s) <= std::max(kNear_s, kShare * second_s);
}

double SpreadShare(const std::vector<double>& values) {
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  return *most / *least - 1.0;
}

Verdict LessSpreadRule(const std::vector<double>& first, const std::vector<double>& second) {
  return VerdictOf({SpreadShare(first) < SpreadShare(second)});
}

Verdict SlightlyMoreLagRule(const std::vector<std::array<double, 2>>& first_then_second_s) {
  std::vector<bool> parts;
  for (const auto& [first, second] : first_then_second_s) {
    parts.push_back(first > second && first - second <= kSlightLag_s);
  }
  return VerdictOf(parts);
}

bool Counts(double effect, double main_effect) { return effect > kInteractionShare * main_effect; }

Verdict ActsOnBothRule(const std::array<double, 2>& effect, const std::array<double, 2>& main) {
  const bool first = Counts(effect[0], main[0]), second = Counts(effect[1], main[1]);
  return VerdictOf({first, second, second && effect[1] > effect[0]});
}

Verdict OwnMoreRule(const std::array<double, 2>& own, const std::array<double, 2>& other) {
  std::vector<bool> parts;
  for (std::size_t i = 0; i < 2; ++i) {
    parts.push_back(Counts(other[i], own[i]) && other[i] < own[i]);
  }
  return VerdictOf(parts);
}

}  // namespace flexarm
