#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <vector>

#include "tools/analysis/statement.h"

// How figures become verdicts. Pure functions of figures, each with every verdict within reach:
// tests/tools/thesis/verdict_rules_test.cpp feeds them.

namespace flexarm {

/// A figure of several runs: median, least and greatest over the seeds. NaN if no run completed.
struct OverSeeds {
  double median = std::numeric_limits<double>::quiet_NaN();  ///< in the figure's unit
  double least = median, most = median;                      ///< likewise

  double scatter() const { return most - least; }
};

/// A figure of a closed loop, and whether all of its runs completed.
struct Outcome {
  bool completed = false;
  OverSeeds value;
};

/// Smaller shares of a figure count as no difference.
inline constexpr double kSameShare = 0.05;
/// Smaller shares of the main effect count as no interaction.
inline constexpr double kInteractionShare = 0.01;

/// Of the parts of a statement, or of the cases that it speaks of: all hold, some, or none.
Verdict VerdictOf(const std::vector<bool>& parts);

/// a is greater than b by more than a share of b and by more than either scatter between seeds.
bool ClearlyGreater(const OverSeeds& a, const OverSeeds& b, double share = kSameShare);
/// A loop that does not complete is worse than one that does.
bool ClearlyWorse(const Outcome& a, const Outcome& b, double share = kSameShare);

/// Two loops in the same case.
struct Contrast {
  Outcome first, second;
};

/// "The first is worse (larger) than the second", case by case.
Verdict WorseRule(const std::vector<Contrast>& cases, double share = kSameShare);
/// "The first is as good as the second": it completes, and is not clearly worse.
Verdict AsGoodRule(const std::vector<Contrast>& cases, double share);
/// "The loop is unstable": completed runs of each case, out of `runs`.
Verdict UnstableRule(const std::vector<std::size_t>& completed, std::size_t runs);

/// "The best setting is near ..": the best of each case lies within the interval.
Verdict NearRule(const std::vector<double>& best, double from, double to);
/// "The middle setting is better than both ends."
/// @param cases  low end, middle, high end
Verdict BetterInsideRule(const std::vector<std::array<OverSeeds, 3>>& cases);

/// How an arm comes to rest after a command.
struct RestOutcome {
  bool completed = false;
  double within_15mm_s = 0.0, within_5mm_s = 0.0;  ///< infinite: never
  double last_second_mm = 0.0;                     ///< rms of the motion
};
/// More motion of the tip than this is no rest.
inline constexpr double kRestMotion_mm = 1.0;
/// "Damped within .. s": both bands by then, and no motion above kRestMotion_mm at the end.
Verdict DampedRule(const std::vector<RestOutcome>& cases, double within_s);

/// "The steady state error is zero": no larger than a bound.
Verdict FinalErrorRule(const std::vector<Outcome>& final_deg, double bound_deg);

/// "Best in the middle case": joint by joint, the middle is clearly smaller than both others.
Verdict BestInMiddleRule(const std::vector<std::array<OverSeeds, 3>>& joints);

/// Figures that a heavier payload changes.
struct LoadFigures {
  std::array<OverSeeds, 2> torque_nm, bending_mm;
  double lowest_hz;
};
/// "More torque, larger bending, lower frequency": both joints, both links.
/// @param light_then_heavy  case by case
Verdict HeavierRule(const std::vector<std::array<LoadFigures, 2>>& light_then_heavy);

/// "It lasts about as long": within a quarter, or a quarter of a second.
bool AsLong(double first_s, double second_s);

/// "The payload matters less in the first than in the second": relative spread over the payloads.
Verdict LessSpreadRule(const std::vector<double>& first, const std::vector<double>& second);
double SpreadShare(const std::vector<double>& values);

/// "The lag is slightly greater": greater, by no more than this.
inline constexpr double kSlightLag_s = 0.02;
Verdict SlightlyMoreLagRule(const std::vector<std::array<double, 2>>& first_then_second_s);

// --- chapter 5

/// An effect on a quantity counts if it exceeds kInteractionShare of the main one.
bool Counts(double effect, double main_effect);
/// "Acts on both, on the second more."
Verdict ActsOnBothRule(const std::array<double, 2>& effect, const std::array<double, 2>& main);
/// "Each depends on the other's parameters, but more on its own."
Verdict OwnMoreRule(const std::array<double, 2>& own, const std::array<double, 2>& other);

}  // namespace flexarm
