// Each rule with figures for which it returns each of its verdicts.

#include "tools/thesis/verdict_rules.h"

#include <gtest/gtest.h>

namespace flexarm {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

OverSeeds Exact(double value) { return {.median = value, .least = value, .most = value}; }
OverSeeds Scattered(double value, double by) {
  return {.median = value, .least = value - by / 2, .most = value + by / 2};
}
Outcome Done(double value) { return {.completed = true, .value = Exact(value)}; }
const Outcome kTripped{};

TEST(VerdictRules, CountTheParts) {
  EXPECT_EQ(VerdictOf({true, true}), Verdict::kHolds);
  EXPECT_EQ(VerdictOf({true, false}), Verdict::kInPart);
  EXPECT_EQ(VerdictOf({false, false}), Verdict::kDoesNot);
}

TEST(VerdictRules, ADifferenceMustExceedItsShareAndTheScatterBetweenSeeds) {
  EXPECT_TRUE(ClearlyGreater(Exact(1.1), Exact(1.0)));
  EXPECT_FALSE(ClearlyGreater(Exact(1.04), Exact(1.0)));
  EXPECT_FALSE(ClearlyGreater(Scattered(1.1, 0.2), Exact(1.0)));
  EXPECT_FALSE(ClearlyGreater(Exact(1.1), Scattered(1.0, 0.2)));
  EXPECT_FALSE(ClearlyGreater(OverSeeds{}, Exact(1.0)));
}

TEST(VerdictRules, ALoopThatTripsIsWorse) {
  EXPECT_TRUE(ClearlyWorse(kTripped, Done(9.0)));
  EXPECT_FALSE(ClearlyWorse(Done(9.0), kTripped));
  EXPECT_FALSE(ClearlyWorse(kTripped, kTripped));
}

TEST(VerdictRules, Worse) {
  const Contrast worse{Done(2.0), Done(1.0)}, better{Done(1.0), Done(2.0)};
  EXPECT_EQ(WorseRule({worse, worse}), Verdict::kHolds);
  EXPECT_EQ(WorseRule({worse, better}), Verdict::kInPart);
  EXPECT_EQ(WorseRule({better, {Done(1.0), Done(1.0)}}), Verdict::kDoesNot);
}

TEST(VerdictRules, AsGood) {
  const Contrast same{Done(1.05), Done(1.0)}, worse{Done(1.2), Done(1.0)};
  EXPECT_EQ(AsGoodRule({same, {Done(1.0), kTripped}}, 0.1), Verdict::kHolds);
  EXPECT_EQ(AsGoodRule({same, worse}, 0.1), Verdict::kInPart);
  EXPECT_EQ(AsGoodRule({worse, {kTripped, kTripped}}, 0.1), Verdict::kDoesNot);
}

TEST(VerdictRules, Unstable) {
  EXPECT_EQ(UnstableRule({0, 2}, 3), Verdict::kHolds);
  EXPECT_EQ(UnstableRule({0, 3}, 3), Verdict::kInPart);
  EXPECT_EQ(UnstableRule({3, 3}, 3), Verdict::kDoesNot);
}

TEST(VerdictRules, Near) {
  EXPECT_EQ(NearRule({2.5, 3.5}, 2.5, 3.5), Verdict::kHolds);
  EXPECT_EQ(NearRule({3.0, 5.0}, 2.5, 3.5), Verdict::kInPart);
  EXPECT_EQ(NearRule({0.0, 5.0}, 2.5, 3.5), Verdict::kDoesNot);
}

TEST(VerdictRules, BetterInside) {
  EXPECT_EQ(BetterInsideRule({{Exact(2), Exact(1), Exact(2)}}), Verdict::kHolds);
  EXPECT_EQ(BetterInsideRule({{Exact(1), Exact(1), Exact(2)}}), Verdict::kInPart);
  EXPECT_EQ(BetterInsideRule({{Exact(1), Exact(1), Exact(1)}}), Verdict::kDoesNot);
}

TEST(VerdictRules, DampedLooksAtBothBandsAndAtMotion) {
  const RestOutcome rests{true, 0.5, 0.9, 0.3};
  const RestOutcome keeps_swinging{true, 0.6, kNever, 7.0};
  const RestOutcome never{true, kNever, kNever, 20.0}, tripped{};
  EXPECT_EQ(DampedRule({rests, rests}, 2.0), Verdict::kHolds);
  EXPECT_EQ(DampedRule({rests, keeps_swinging}, 2.0), Verdict::kInPart);
  EXPECT_EQ(DampedRule({keeps_swinging}, 2.0), Verdict::kInPart);
  EXPECT_EQ(DampedRule({never, tripped}, 2.0), Verdict::kDoesNot);
}

TEST(VerdictRules, FinalError) {
  EXPECT_EQ(FinalErrorRule({Done(0.1), Done(0.2)}, 0.28), Verdict::kHolds);
  EXPECT_EQ(FinalErrorRule({Done(0.1), Done(0.4)}, 0.28), Verdict::kInPart);
  EXPECT_EQ(FinalErrorRule({Done(0.4), kTripped}, 0.28), Verdict::kDoesNot);
}

TEST(VerdictRules, BestInMiddle) {
  const std::array<OverSeeds, 3> best{Exact(2), Exact(1), Exact(2)};
  const std::array<OverSeeds, 3> rising{Exact(1), Exact(2), Exact(3)};
  EXPECT_EQ(BestInMiddleRule({best, best}), Verdict::kHolds);
  EXPECT_EQ(BestInMiddleRule({best, rising}), Verdict::kInPart);
  EXPECT_EQ(BestInMiddleRule({rising, rising}), Verdict::kDoesNot);
}

TEST(VerdictRules, HeavierLooksAtBothLinks) {
  const LoadFigures light{{Exact(1), Exact(1)}, {Exact(119), Exact(60)}, 7.6};
  const LoadFigures heavy{{Exact(2), Exact(2)}, {Exact(125), Exact(90)}, 6.3};
  const LoadFigures link1_bends_less{{Exact(2), Exact(2)}, {Exact(115), Exact(90)}, 6.3};
  EXPECT_EQ(HeavierRule({{light, heavy}}), Verdict::kHolds);
  EXPECT_EQ(HeavierRule({{light, link1_bends_less}}), Verdict::kInPart);
  EXPECT_EQ(HeavierRule({{heavy, light}}), Verdict::kDoesNot);
}

TEST(VerdictRules, AsLong) {
  EXPECT_TRUE(AsLong(0.5, 0.7));
  EXPECT_TRUE(AsLong(2.2, 2.0));
  EXPECT_FALSE(AsLong(0.5, 0.8));
  EXPECT_FALSE(AsLong(kNever, 0.8));
}

TEST(VerdictRules, LessSpread) {
  EXPECT_EQ(LessSpreadRule({1.0, 1.1}, {1.0, 2.0}), Verdict::kHolds);
  EXPECT_EQ(LessSpreadRule({1.0, 2.0}, {1.0, 1.1}), Verdict::kDoesNot);
}

TEST(VerdictRules, SlightlyMoreLag) {
  const std::array<double, 2> slight{0.03, 0.02}, much{0.2, 0.02}, less{0.01, 0.02};
  EXPECT_EQ(SlightlyMoreLagRule({slight, slight}), Verdict::kHolds);
  EXPECT_EQ(SlightlyMoreLagRule({slight, much}), Verdict::kInPart);
  EXPECT_EQ(SlightlyMoreLagRule({less, much}), Verdict::kDoesNot);
}

TEST(VerdictRules, AnInteractionMustExceedOnePercentOfTheMainEffect) {
  EXPECT_TRUE(Counts(2.0, 100.0));
  EXPECT_FALSE(Counts(0.9, 100.0));
  EXPECT_EQ(ActsOnBothRule({2, 4}, {100, 100}), Verdict::kHolds);
  EXPECT_EQ(ActsOnBothRule({0.05, 4}, {100, 100}), Verdict::kInPart);
  EXPECT_EQ(ActsOnBothRule({0.05, 0.1}, {100, 100}), Verdict::kDoesNot);
  EXPECT_EQ(OwnMoreRule({150, 137}, {2, 6}), Verdict::kHolds);
  EXPECT_EQ(OwnMoreRule({150, 137}, {0.9, 6}), Verdict::kInPart);
  EXPECT_EQ(OwnMoreRule({150, 137}, {0.9, 200}), Verdict::kDoesNot);
}

}  // namespace
}  // namespace flexarm
