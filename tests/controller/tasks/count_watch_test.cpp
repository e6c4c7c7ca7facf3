#include "controller/tasks/count_watch.h"

#include <gtest/gtest.h>

#include <numbers>

namespace flexarm {
namespace {

// 2 degrees are 14.1 counts.
class CountWatchTest : public testing::Test {
 protected:
  void Read(std::uint32_t hub, std::uint32_t rotor, std::uint32_t valid = 0b101) {
    SensorFrame part{};
    part.counter[0] = hub;
    part.counter[2] = rotor;
    part.counter_valid = valid;
    watch_.Take(part);
  }
  static SensorConfig Sensors() {
    SensorConfig sensors{};
    sensors.encoder = {
        {.counter = 0, .counts_per_turn = 2540, .counter_bits = 12, .sign = 1},
        {.counter = 2, .counts_per_turn = 2540, .counter_bits = 32, .sign = -1},
    };
    return sensors;
  }

  CountWatch watch_{Sensors()};
};

TEST_F(CountWatchTest, ReadingsInARowMayMoveAsTheyLike) {
  for (const std::uint32_t counts : {0U, 500U, 4000U, 10U}) Read(counts, counts);
  EXPECT_EQ(watch_.epochs(), CountEpochs{});
}

TEST_F(CountWatchTest, TheFirstReadingIsComparedWithNothing) {
  watch_.Reconnected();
  Read(500, 500);
  EXPECT_EQ(watch_.epochs(), CountEpochs{});
}

TEST_F(CountWatchTest, ACounterThatRestartsWhileTheBusIsAwayHasLostItsCount) {
  Read(212, 212);
  watch_.Reconnected();
  Read(0, 205);
  EXPECT_EQ(watch_.epochs(), (CountEpochs{1, 0, 0, 0}));
  Read(100, 0);
  EXPECT_EQ(watch_.epochs(), (CountEpochs{1, 0, 0, 0})) << "compared once";
  watch_.Reconnected();
  Read(100, 15);
  EXPECT_EQ(watch_.epochs(), (CountEpochs{1, 0, 1, 0}));
}

TEST_F(CountWatchTest, WhatAnArmAtRestTurnsIsNoLoss) {
  Read(1000, 1000);
  watch_.Reconnected();
  Read(1014, 986);
  EXPECT_EQ(watch_.epochs(), CountEpochs{});
  watch_.Reconnected();
  Read(1029, 971);
  EXPECT_EQ(watch_.epochs(), (CountEpochs{1, 0, 1, 0}));
}

// The most that an arm at rest turns, to the count: here 20 of them.
TEST_F(CountWatchTest, ExactlyWhatAnArmAtRestTurnsIsNoLoss) {
  SensorConfig sensors = Sensors();
  sensors.encoder[0].counts_per_turn = 20.0 * 2.0 * std::numbers::pi / CountWatch::kRestTurnRad;
  watch_ = CountWatch(sensors);
  Read(1000, 0);
  watch_.Reconnected();
  Read(1020, 0);
  EXPECT_EQ(watch_.epochs(), CountEpochs{});
  watch_.Reconnected();
  Read(1041, 0);
  EXPECT_EQ(watch_.epochs(), (CountEpochs{1, 0, 0, 0}));
}

TEST_F(CountWatchTest, ACounterIsComparedAcrossItsOverflow) {
  Read(4090, 0xFFFF'FFFA);
  watch_.Reconnected();
  Read(4, 4);
  EXPECT_EQ(watch_.epochs(), CountEpochs{});
}

TEST_F(CountWatchTest, AReadingThatIsNotValidWaitsForTheNext) {
  Read(212, 212);
  watch_.Reconnected();
  Read(0, 0, 0);
  EXPECT_EQ(watch_.epochs(), CountEpochs{});
  Read(0, 212);
  EXPECT_EQ(watch_.epochs(), (CountEpochs{1, 0, 0, 0}));
}

}  // namespace
}  // namespace flexarm
