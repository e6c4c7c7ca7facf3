#include "controller/health/drift_trend.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace flexarm {
namespace {

using ::testing::HasSubstr;

const std::vector<DriftChannel> kChannels = {
    {.kind = DriftKind::kGaugeGain, .part = 1, .gauge = 7, .strain = 0},
    {.kind = DriftKind::kGaugeZero, .part = 1, .gauge = 7, .strain = 0},
    {.kind = DriftKind::kFriction, .part = 2, .gauge = 0, .strain = 0}};
const std::vector<DriftScale> kScales = {
    {.prior = 0.3, .step = 0.0, .linear = 0.0, .floor = 0.003},
    {.prior = 1e-3, .step = 0.0, .linear = 0.0, .floor = 2e-6},
    {.prior = 0.01, .step = 0.0, .linear = 0.0, .floor = 5e-4}};

HealthRecord RunOf(int number, double gain) {
  return {.run = std::to_string(number),
          .start_utc = "2026-10-" + std::string(number < 9 ? "0" : "") +
                       std::to_string(number + 1) + "T00:00:00Z",
          .unused = {},
          .plant = 1,
          .zero_counts = {0.0F},
          .gain_error = {0.0F},
          .misfit = 1.0,
          .drift = {{gain, 0.001}, {0.0, 1e-6}, {0.0, 1e-4}}};
}

HealthHistory Ramp(int runs, double step) {
  HealthHistory history;
  for (int i = 0; i < runs; ++i) history.Add(RunOf(i, step * i));
  return history;
}

DriftVerdict OfGain(const HealthHistory& history) {
  return DriftTrends(kChannels, kScales, history)[0].verdict;
}

TEST(DriftTrend, OneRunTellsNoTrend) { EXPECT_EQ(OfGain(Ramp(1, 0.01)), DriftVerdict::kUnknown); }

TEST(DriftTrend, ARampIsFound) {
  EXPECT_EQ(OfGain(Ramp(10, 0.0)), DriftVerdict::kSteady);
  EXPECT_EQ(OfGain(Ramp(10, 0.01)), DriftVerdict::kDrifts);
  EXPECT_EQ(OfGain(Ramp(10, -0.01)), DriftVerdict::kDrifts);
}

// The floor of a gain is 0.3 %: of 4 sigmas, a change of 1 % is none.
TEST(DriftTrend, AChangeWithinTheFloorIsNone) {
  HealthHistory history = Ramp(10, 0.0);
  history.Add(RunOf(10, 0.01));
  EXPECT_EQ(OfGain(history), DriftVerdict::kSteady);
  history.Add(RunOf(11, 0.02));
  EXPECT_EQ(OfGain(history), DriftVerdict::kDrifts);
}

TEST(DriftTrend, ACalibrationOfTheGaugeStartsANewReference) {
  HealthHistory history = Ramp(10, 0.0);
  history.Add(RunOf(10, 0.05));
  ASSERT_EQ(OfGain(history), DriftVerdict::kDrifts);
  history.run.back().gain_error = {0.05F};
  EXPECT_EQ(OfGain(history), DriftVerdict::kUnknown);
  history.run.back().gain_error = {0.0F};
  history.run.back().zero_counts = {3.0F};  // a tare leaves the gain's reference
  EXPECT_EQ(OfGain(history), DriftVerdict::kDrifts);
  history.run.back().plant = 2;
  EXPECT_EQ(OfGain(history), DriftVerdict::kUnknown);
}

TEST(DriftTrend, ARunThatIsNotUsedOrTellsNothingIsLeftOut) {
  for (const bool unused : {true, false}) {
    HealthHistory history = Ramp(10, 0.0);
    HealthRecord run = RunOf(10, 0.05);
    if (unused) run.unused = "samples of the run are missing";
    if (!unused) run.drift[0].standard_error = 0.1;
    history.Add(run);
    EXPECT_EQ(OfGain(history), DriftVerdict::kSteady);
  }
}

// 0.1 of the gain are 100 standard errors; 3 mN m are 4.2 of its error and floor together, and 6 of
// its standard error.
TEST(DriftTrend, AFaintChangeBesideAPlainOneIsLeftOut) {
  HealthHistory history = Ramp(10, 0.0);
  HealthRecord run = RunOf(10, 0.1);
  run.drift[2] = {3e-3, 5e-4};
  history.Add(run);
  EXPECT_EQ(OfGain(history), DriftVerdict::kDrifts);
  EXPECT_EQ(DriftTrends(kChannels, kScales, history)[2].verdict, DriftVerdict::kSteady);
  history.run.back().drift[0].value = 0.0;
  EXPECT_EQ(DriftTrends(kChannels, kScales, history)[2].verdict, DriftVerdict::kDrifts);
}

TEST(DriftTrend, TheAlarmNamesChannelSizeAndReference) {
  const HealthHistory history = Ramp(10, -0.01);
  const std::string text = AlarmText(kChannels[0], DriftTrends(kChannels, kScales, history)[0]);
  EXPECT_THAT(text, HasSubstr("gauge 7 of link 1: gain 6.0 % (+-"));
  EXPECT_THAT(text, HasSubstr("lower than in the runs to 2026-10-05; check its glue"));
}

}  // namespace
}  // namespace flexarm
