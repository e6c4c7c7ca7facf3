#include "controller/exchange/latest_value.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <thread>

#include "controller/exchange/history.h"

namespace flexarm {
namespace {

TEST(History, GivesTheValueThatHeldAtAnInstant) {
  History<int, 4> history(-1);
  EXPECT_EQ(history.At(INT64_MIN).value, -1);
  EXPECT_EQ(history.At(0).value, -1);
  history.Push(100, 1);
  history.Push(200, 2);
  EXPECT_EQ(history.At(99).value, -1);
  EXPECT_EQ(history.At(100).value, 1);
  EXPECT_EQ(history.At(199).value, 1);
  EXPECT_EQ(history.At(200).value, 2);
  EXPECT_EQ(history.At(INT64_MAX).value, 2);
  EXPECT_EQ(history.Newest().value, 2);
  EXPECT_EQ(history.Newest().from_ns, 200);
}

TEST(History, KeepsTheLastNAndGivesTheOldestForEarlierInstants) {
  History<int, 3> history(-1);
  for (int i = 1; i <= 10; ++i) history.Push(i * 100, i);
  EXPECT_EQ(history.At(1000).value, 10);
  EXPECT_EQ(history.At(900).value, 9);
  EXPECT_EQ(history.At(800).value, 8);
  EXPECT_EQ(history.At(700).value, 8) << "700 itself is no longer stored";
}

TEST(History, TheLaterOfTwoValuesOfOneInstantHolds) {
  History<int, 4> history(-1);
  history.Push(100, 1);
  history.Push(100, 2);
  EXPECT_EQ(history.At(100).value, 2);
}

// Whatever number of values the follower lacks: none, some, as many as are kept, more.
TEST(History, FollowsALaterStateOfItself) {
  for (int lacks = 0; lacks <= 9; ++lacks) {
    History<int, 4> newer(-1);
    for (int i = 1; i <= 3; ++i) newer.Push(i * 100, i);
    History<int, 4> follower = newer;
    for (int i = 4; i < 4 + lacks; ++i) newer.Push(i * 100, i);
    follower.Follow(newer);
    for (int instant = 0; instant <= 1300; instant += 50) {
      EXPECT_EQ(follower.At(instant).value, newer.At(instant).value) << lacks << ", " << instant;
      EXPECT_EQ(follower.At(instant).from_ns, newer.At(instant).from_ns) << lacks;
    }
    EXPECT_EQ(follower.Newest().value, newer.Newest().value);
    newer.Push(1300, 99);  // the count of what it has followed is right, too
    follower.Follow(newer);
    EXPECT_EQ(follower.Newest().value, 99);
    EXPECT_EQ(follower.At(1299).value, newer.At(1299).value);
  }
}

TEST(LatestValue, GivesTheInitialValueUntilOneIsPublishedAndThenTheNewest) {
  LatestValue<int> channel(7);
  EXPECT_EQ(channel.Read(), 7);
  channel.Publish(1);
  channel.Publish(2);
  EXPECT_EQ(channel.Read(), 2);
  EXPECT_EQ(channel.Read(), 2) << "no newer value: the same again";
  channel.Publish(3);
  EXPECT_EQ(channel.Read(), 3);
}

// Every word of a value carries its number, so a torn copy is detected. Run with the thread
// sanitizer too.
TEST(LatestValue, TwoThreadsNeverSeeATornOrAnOlderValue) {
  using Wide = std::array<std::uint64_t, 64>;
  constexpr std::uint64_t kLast = 50'000;
  LatestValue<Wide> channel{Wide{}};
  std::thread writer([&channel] {
    for (std::uint64_t i = 1; i <= kLast; ++i) {
      Wide value;
      value.fill(i);
      channel.Publish(value);
    }
  });
  std::uint64_t seen = 0;
  std::uint64_t torn = 0;
  std::uint64_t older = 0;
  while (seen < kLast) {
    const Wide& value = channel.Read();
    for (const std::uint64_t word : value) torn += word != value[0];
    older += value[0] < seen;
    seen = value[0];
  }
  writer.join();
  EXPECT_EQ(torn, 0u);
  EXPECT_EQ(older, 0u);
}

using Squares = History<std::int64_t, 8>;

// Publishes the squares of 1, 2, .. and looks at all that is in the history that is read.
void ExpectNoTornHistory(void (*publish)(LatestValue<Squares>&, const Squares&)) {
  constexpr std::int64_t kLast = 20'000;
  LatestValue<Squares> channel{Squares(0)};
  std::thread writer([&channel, publish] {
    Squares history(0);
    for (std::int64_t i = 1; i <= kLast; ++i) {
      history.Push(i, i * i);
      publish(channel, history);
    }
  });
  std::int64_t newest = 0;
  std::int64_t wrong = 0;
  while (newest < kLast) {
    const Squares& history = channel.Read();
    newest = history.Newest().from_ns;
    if (newest < 8) continue;
    for (std::int64_t back = 0; back < 8; ++back) {
      const std::int64_t i = newest - back;
      wrong += history.At(i).value != i * i;
    }
  }
  writer.join();
  EXPECT_EQ(wrong, 0);
}

TEST(LatestValue, TwoThreadsNeverSeeATornHistory) {
  ExpectNoTornHistory(
      [](LatestValue<Squares>& channel, const Squares& history) { channel.Publish(history); });
}

// Each of the three buffers lacks another number of values, which depends on the reader.
TEST(LatestValue, TwoThreadsNeverSeeATornHistoryThatGrows) {
  ExpectNoTornHistory(
      [](LatestValue<Squares>& channel, const Squares& history) { channel.PublishGrown(history); });
}

}  // namespace
}  // namespace flexarm
