#include "tools/tuning/tuning_search.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "tests/config/config_testing.h"
#include "tools/tuning/move_check.h"

namespace flexarm {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

TEST(DesignScore, IsPositiveExactlyIfEveryCheckPasses) {
  const DesignScore shipped = ScoreOf(HilWith({}));
  EXPECT_EQ(shipped.result, DesignVerdict::Result::kSound);
  EXPECT_GT(shipped.value, 0.0);
  // Of the newcomer: with these noises on a heavier arm the filter believes its gauges too much.
  const DesignScore unstable =
      ScoreOf(HilWith({"estimator.process_force=[3, 0.5, 500, 500, 150, 150]"}));
  EXPECT_EQ(unstable.result, DesignVerdict::Result::kRejected);
  EXPECT_LE(unstable.value, 0.0);
  EXPECT_THAT(unstable.found, Not(IsEmpty()));
}

TEST(DesignScore, IsLeastWithoutADesign) {
  RigConfig config = HilWith({});
  config.controller.torque_weight = std::numeric_limits<double>::quiet_NaN();
  EXPECT_LE(ScoreOf(config).value, -1.0);
}

TEST(TuneDesign, MakesAnUnsoundDesignSound) {
  const RigConfig config = HilWith({"estimator.process_force=[3, 0.5, 500, 500, 150, 150]"});
  const Tuning tuning = TuneDesign(config, 30);
  EXPECT_EQ(tuning.before.result, DesignVerdict::Result::kRejected);
  EXPECT_EQ(tuning.after.result, DesignVerdict::Result::kSound) << tuning.after.found;
  EXPECT_THAT(tuning.changed, Not(IsEmpty()));
  std::vector<std::string> overrides;
  for (const TunedKey& key : tuning.changed) overrides.push_back(key.key + "=" + key.after);
  EXPECT_EQ(WithOverrides(config, overrides).text, tuning.config.text)
      << "the printed changes are the config";
}

TEST(TuneDesign, ChangesNothingWithoutATry) {
  const Tuning tuning = TuneDesign(HilWith({}), 0);
  EXPECT_THAT(tuning.changed, IsEmpty());
  EXPECT_EQ(tuning.before.value, tuning.after.value);
}

TEST(Obstacles, NameTheModeTheFilterAndTheSensorInTheWay) {
  const auto found = [](const std::vector<std::string>& overrides) {
    std::string text;
    for (const std::string& obstacle : ObstaclesOf(HilWith(overrides))) text += obstacle + "\n";
    return text;
  };
  EXPECT_THAT(found({"loop.period_ms=40", "loop.acquire_before_ms=20",
                     "estimator.max_joint_rate_rad_s=7", "limits.hub_rate_rad_s=[5, 5]"}),
              HasSubstr("above half the sampling rate, 12.5 Hz"));
  EXPECT_THAT(found({"sensors.strain_input.filter_hz=1"}),
              HasSubstr("filter of 1 Hz is slower than the first mode"));
  EXPECT_THAT(
      found({"sensors.encoder[0].counts_per_turn=300", "sensors.encoder[0].counter_bits=16"}),
      HasSubstr("one count of the encoder of hub1 is 35.6 mm at the tip"));
  EXPECT_THAT(found({}), HasSubstr("stiffen the arm"));
}

}  // namespace
}  // namespace flexarm
