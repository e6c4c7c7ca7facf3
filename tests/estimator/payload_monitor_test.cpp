// Warnings of the payload estimate: when each is raised and when it is cleared.

#include "estimator/payload_monitor.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>

#include "tests/support/study_payload.h"

namespace flexarm {
namespace {

constexpr double kMax_kg = 1.1, kMoveSigma_kg = 0.1;  // of StudyEstimator
constexpr double kRightNis = 8.0;

PayloadMonitor Monitor() { return PayloadMonitor(*StudyEstimator().payload); }

PayloadFilter::Estimate Found(double payload_kg, double sigma_kg) {
  PayloadFilter::Estimate found{};
  found.payload_kg = payload_kg;
  found.payload_sigma_kg = sigma_kg;
  found.friction_nm = {0.16, 0.01};
  return found;
}

/// One sample of motion, then rest, with this standard deviation at the end of the motion.
std::uint32_t WarningsAfterAMove(double sigma_kg, PayloadMonitor* monitor) {
  monitor->Judge(Found(0.3, kMoveSigma_kg), kRightNis, true);
  return monitor->Judge(Found(0.3, sigma_kg), kRightNis, false).warnings;
}

TEST(PayloadMonitor, ReportsTheEstimateOfTheFilter) {
  const PayloadKnowledge known = Monitor().Judge(Found(0.3, 0.02), 9.0, true);
  EXPECT_EQ(known.payload_kg, 0.3);
  EXPECT_EQ(known.payload_sigma_kg, 0.02);
  EXPECT_EQ(known.friction_nm, (std::array<double, 2>{0.16, 0.01}));
  EXPECT_EQ(known.mean_nis, 9.0);
  EXPECT_EQ(known.warnings, 0u);
}

TEST(PayloadMonitor, WarnsWhileThePayloadIsAtItsBound) {
  for (const bool moving : {true, false}) {
    PayloadMonitor monitor = Monitor();
    EXPECT_EQ(monitor.Judge(Found(1.099, 0.0), kRightNis, moving).warnings, 0u);
    EXPECT_EQ(monitor.Judge(Found(kMax_kg, 0.0), kRightNis, moving).warnings,
              static_cast<std::uint32_t>(kPayloadAtBound));
    EXPECT_EQ(monitor.Judge(Found(1.099, 0.0), kRightNis, moving).warnings, 0u);
  }
}

// At the same NIS at which SchedulingPayload gives the robust gains only.
TEST(PayloadMonitor, WarnsWhileTheInnovationsContradictTheModel) {
  for (const bool moving : {true, false}) {
    PayloadMonitor monitor = Monitor();
    EXPECT_EQ(monitor.Judge(Found(0.3, 0.0), kModelWrongNis, moving).warnings, 0u);
    EXPECT_EQ(monitor.Judge(Found(0.3, 0.0), 60.1, moving).warnings,
              static_cast<std::uint32_t>(kPayloadModelMismatch));
    EXPECT_EQ(monitor.Judge(Found(0.3, 0.0), kRightNis, moving).warnings, 0u);
  }
}

TEST(PayloadMonitor, WarnsAfterAMoveWithoutObservabilityUntilTheNextBegins) {
  PayloadMonitor monitor = Monitor();
  EXPECT_EQ(monitor.Judge(Found(0.3, 0.4), kRightNis, true).warnings, 0u) << "the move is not over";
  for (const double sigma_kg : {0.1, 0.4, 0.01}) {
    EXPECT_EQ(monitor.Judge(Found(0.3, sigma_kg), kRightNis, false).warnings,
              static_cast<std::uint32_t>(kPayloadNotObservable))
        << sigma_kg << ": the result at the end of the move holds";
  }
  EXPECT_EQ(monitor.Judge(Found(0.3, 0.4), kRightNis, true).warnings, 0u) << "the next move begins";
  EXPECT_EQ(monitor.Judge(Found(0.3, 0.099), kRightNis, false).warnings, 0u)
      << "the payload was observable";
}

// With a random walk of 3 g per sample the standard deviation exceeds 0.1 kg after 22 s at 50 Hz.
TEST(PayloadMonitor, ALongRestRaisesNoWarning) {
  PayloadMonitor monitor = Monitor();
  EXPECT_EQ(WarningsAfterAMove(0.02, &monitor), 0u);
  double variance_kg2 = 0.02 * 0.02;
  for (int k = 0; k < 1500; ++k) {
    variance_kg2 += 0.003 * 0.003;
    ASSERT_EQ(monitor.Judge(Found(0.3, std::sqrt(variance_kg2)), kRightNis, false).warnings, 0u)
        << k;
  }
  EXPECT_GT(std::sqrt(variance_kg2), kMoveSigma_kg) << "the rest is too short for this test";
}

TEST(PayloadMonitor, NoWarningBeforeTheFirstMove) {
  EXPECT_EQ(Monitor().Judge(Found(0.2, 0.4), kRightNis, false).warnings, 0u);
}

TEST(PayloadMonitor, AResetClearsTheMoveAndItsWarning) {
  PayloadMonitor monitor = Monitor();
  ASSERT_NE(WarningsAfterAMove(0.4, &monitor), 0u);
  monitor.Reset();
  EXPECT_EQ(monitor.Judge(Found(0.2, 0.4), kRightNis, false).warnings, 0u);
  monitor.Judge(Found(0.2, 0.4), kRightNis, true);
  monitor.Reset();
  EXPECT_EQ(monitor.Judge(Found(0.2, 0.4), kRightNis, false).warnings, 0u)
      << "a move that a reset aborted has not ended";
}

}  // namespace
}  // namespace flexarm
