#include "controller/exchange/latest_value.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <thread>
#include <type_traits>

#include "controller/exchange/history.h"

namespace flexarm {
namespace {

// Two writers would each own a buffer that the other publishes.
static_assert(!std::is_copy_constructible_v<LatestValue<int>>);
static_assert(!std::is_copy_assignable_v<LatestValue<int>>);

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
