#include "controller/step/actuation_queue.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

std::int64_t Ticks(double ms) { return std::llround(ms / 20.0 * kPeriodTicks); }

void ExpectPieces(const PiecewiseTorque& pieces,
                  const std::vector<std::pair<double, double>>& nm_ms) {
  ASSERT_EQ(pieces.all().size(), nm_ms.size());
  for (std::size_t i = 0; i < nm_ms.size(); ++i) {
    EXPECT_EQ(pieces.all()[i].torque_nm[0], nm_ms[i].first) << i;
    EXPECT_NEAR(static_cast<double>(pieces.all()[i].ticks),
                static_cast<double>(Ticks(nm_ms[i].second)), 1.0)
        << i;
  }
}

ActuationQueue Three() {
  ActuationQueue line;
  line.Push(0, {1.0, 0.0});
  line.Push(26 * kMs, {2.0, 0.0});
  line.Push(46 * kMs, {3.0, 0.0});
  return line;
}

TEST(ActuationQueue, DividesAnIntervalWhereTheTorqueChanges) {
  ExpectPieces(Three().Between(20 * kMs, 54 * kMs, kPeriodNs), {{1.0, 6}, {2.0, 20}, {3.0, 8}});
  ExpectPieces(Three().Between(26 * kMs, 46 * kMs, kPeriodNs), {{2.0, 20}});
  ExpectPieces(Three().Between(30 * kMs, 40 * kMs, kPeriodNs), {{2.0, 10}});
}

TEST(ActuationQueue, TheTorqueIsZeroBeforeTheFirst) {
  ExpectPieces(Three().Between(-10 * kMs, 10 * kMs, kPeriodNs), {{0.0, 10}, {1.0, 10}});
  ExpectPieces(ActuationQueue().Between(0, kPeriodNs, kPeriodNs), {{0.0, 20}});
}

// A torque of zero duration gives no piece; a whole period gives exactly one.
TEST(ActuationQueue, ChangesAtTheEndsOfTheIntervalAddNoPiece) {
  ActuationQueue line;
  for (int k = 0; k < 4; ++k) line.Push(k * kPeriodNs, {1.0 * k, 0.0});
  const PiecewiseTorque pieces = line.Between(kPeriodNs, 2 * kPeriodNs, kPeriodNs);
  ASSERT_EQ(pieces.all().size(), 1u);
  EXPECT_EQ(pieces.all()[0].ticks, kPeriodTicks);
  EXPECT_EQ(pieces.last_nm()[0], 1.0);
  ExpectPieces(line.Between(kPeriodNs, kPeriodNs, kPeriodNs), {});
  ExpectPieces(line.Between(kPeriodNs, 0, kPeriodNs), {});
}

TEST(ActuationQueue, RoundedPiecesSumToTheWholePeriod) {
  ActuationQueue line;
  for (int i = 0; i < 5; ++i) line.Push(3'333'333 * (i + 1), {1.0 * i, 0.0});
  const PiecewiseTorque pieces = line.Between(0, kPeriodNs, kPeriodNs);
  std::int64_t sum = 0;
  for (const TorquePiece& piece : pieces.all()) sum += piece.ticks;
  EXPECT_EQ(sum, kPeriodTicks);
}

TEST(ActuationQueue, CorrectsTheNewestButNotBeforeThePrevious) {
  ActuationQueue line = Three();
  line.CorrectNewest(50 * kMs);
  ExpectPieces(line.Between(26 * kMs, 60 * kMs, kPeriodNs), {{2.0, 24}, {3.0, 10}});
  line.CorrectNewest(0);  // clamped to the previous instant
  ExpectPieces(line.Between(20 * kMs, 40 * kMs, kPeriodNs), {{1.0, 6}, {3.0, 14}});
  ActuationQueue empty;
  empty.CorrectNewest(5);
  ExpectPieces(empty.Between(0, kPeriodNs, kPeriodNs), {{0.0, 20}});
}

TEST(ActuationQueue, HoldsEightTorquesAndSixPeriodsAhead) {
  ActuationQueue line;
  for (int k = 0; k < 9; ++k) line.Push(k * kPeriodNs, {1.0 + k, 0.0});
  ExpectPieces(line.Between(0, 2 * kPeriodNs, kPeriodNs), {{0.0, 20}, {2.0, 20}});
  ExpectPieces(line.Between(8 * kPeriodNs, 100 * kPeriodNs, kPeriodNs), {{9.0, 120}});
}

// The instants and sizes of the changes stay; the mean becomes the measured one, after the gate.
TEST(PiecewiseTorque, TakesTheMeasuredMean) {
  const PiecewiseTorque asked =
      Three().Between(20 * kMs, 40 * kMs, kPeriodNs);  // 1 for 6, 2 for 14
  const PiecewiseTorque applied = asked.WithMean({1.2, 0.3});
  double sum1 = 0.0, sum2 = 0.0;
  for (const TorquePiece& piece : applied.all()) {
    sum1 += static_cast<double>(piece.ticks) * piece.torque_nm[0];
    sum2 += static_cast<double>(piece.ticks) * piece.torque_nm[1];
  }
  EXPECT_NEAR(sum1 / kPeriodTicks, 1.2, 1e-15);
  EXPECT_NEAR(sum2 / kPeriodTicks, 0.3, 1e-15);
  EXPECT_NEAR(applied.all()[1].torque_nm[0] - applied.all()[0].torque_nm[0], 1.0, 1e-15);
  EXPECT_EQ(PiecewiseTorque::WholePeriod({7.0, 8.0}).WithMean({0.1, 0.2}).last_nm(),
            (std::array{0.1, 0.2}));
}

}  // namespace
}  // namespace flexarm
