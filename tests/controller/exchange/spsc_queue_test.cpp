#include "controller/exchange/spsc_queue.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <memory>
#include <thread>
#include <type_traits>

namespace flexarm {
namespace {

// A copy would hand over each value a second time.
static_assert(!std::is_copy_constructible_v<SpscQueue<int>>);
static_assert(!std::is_copy_assignable_v<SpscQueue<int>>);

TEST(SpscQueue, ReturnsValuesInOrder) {
  SpscQueue<int> queue(8);
  int value = 0;
  EXPECT_FALSE(queue.Pop(&value));
  for (int i = 0; i < 8; ++i) EXPECT_TRUE(queue.Push(i));
  EXPECT_EQ(queue.size(), 8u);
  for (int i = 0; i < 8; ++i) {
    ASSERT_TRUE(queue.Pop(&value));
    EXPECT_EQ(value, i);
  }
  EXPECT_FALSE(queue.Pop(&value));
  EXPECT_EQ(queue.dropped(), 0u);
}

TEST(SpscQueue, DropsAndCountsValuesThatDoNotFit) {
  SpscQueue<int> queue(4);
  int pushed = 0;
  while (queue.Push(pushed)) ++pushed;
  EXPECT_GE(pushed, 4);
  EXPECT_LE(pushed, 64) << "the capacity is fixed";
  EXPECT_EQ(queue.dropped(), 1u);
  EXPECT_FALSE(queue.Push(99));
  EXPECT_EQ(queue.dropped(), 2u);

  int value = -1;
  ASSERT_TRUE(queue.Pop(&value));
  EXPECT_EQ(value, 0) << "the oldest stays, the newest was dropped";
  EXPECT_TRUE(queue.Push(pushed));
  for (int i = 1; i <= pushed; ++i) {
    ASSERT_TRUE(queue.Pop(&value));
    EXPECT_EQ(value, i);
  }
  EXPECT_FALSE(queue.Pop(&value));
}

// The data behind the pointer is not in the queue: the queue must order accesses to it as well. Run
// with the thread sanitizer too.
TEST(SpscQueue, TwoThreadsLoseAndTearNothing) {
  struct Item {
    std::array<std::uint64_t, 16> words;
    const std::uint64_t* payload;
  };
  constexpr std::uint64_t kLast = 20'000;
  SpscQueue<Item> queue(256);
  const auto payload = std::make_unique<std::uint64_t[]>(kLast + 1);
  std::thread producer([&] {
    for (std::uint64_t i = 1; i <= kLast; ++i) {
      payload[i] = i * i;
      Item item{};
      item.words.fill(i);
      item.payload = &payload[i];
      while (!queue.Push(item)) std::this_thread::yield();
    }
  });
  std::uint64_t expected = 1;
  std::uint64_t wrong = 0;
  while (expected <= kLast) {
    Item item;
    if (!queue.Pop(&item)) continue;
    for (const std::uint64_t word : item.words) wrong += word != expected;
    wrong += *item.payload != expected * expected;
    ++expected;
  }
  producer.join();
  EXPECT_EQ(wrong, 0u);
}

}  // namespace
}  // namespace flexarm
