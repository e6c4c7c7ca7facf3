#include "controller/safety/windowed_count.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <deque>
#include <random>

namespace flexarm {
namespace {

// The same by the book: the last n events.
class NaiveCount {
 public:
  explicit NaiveCount(int length) : last_(static_cast<std::size_t>(length), false) {}
  void Push(bool failed) {
    last_.push_back(failed);
    last_.pop_front();
  }
  int count() const { return static_cast<int>(std::count(last_.begin(), last_.end(), true)); }

 private:
  std::deque<bool> last_;
};

constexpr int CountAfter(int length, std::uint32_t events, int many) {
  WindowedCount count(length);
  for (int i = 0; i < many; ++i) count.Push((events >> i & 1u) != 0);
  return count.count();
}
static_assert(CountAfter(4, 0b1111, 4) == 4);
static_assert(CountAfter(4, 0b01111, 5) == 3, "the oldest failure has left");
static_assert(CountAfter(4, 0b1000'0001, 8) == 1);
static_assert(noexcept(WindowedCount(3).Push(true)));

// 12 windows x 65536 sequences.
TEST(WindowedCount, EqualsTheNaiveCountForEverySequenceOfSixteenEvents) {
  for (int length = 1; length <= 12; ++length) {
    for (std::uint32_t events = 0; events < 65'536; ++events) {
      WindowedCount count(length);
      for (int i = 0; i < 16; ++i) {
        count.Push((events >> i & 1u) != 0);
        const int oldest = std::max(i - length + 1, 0);
        const std::uint32_t seen = (events & ((1u << (i + 1)) - 1u)) >> oldest;
        if (count.count() != std::popcount(seen)) {
          FAIL() << "n " << length << ", events " << events << ", after " << i + 1;
        }
      }
    }
  }
}

TEST(WindowedCount, EqualsTheNaiveCountAcrossItsWords) {
  std::mt19937 random(20261124);
  for (const int length : {1, 63, 64, 65, 127, 128, 129, 200, 255, 256}) {
    WindowedCount count(length);
    NaiveCount naive(length);
    for (int i = 0; i < 2'000; ++i) {
      const bool failed = random() % 3 == 0;
      count.Push(failed);
      naive.Push(failed);
      ASSERT_EQ(count.count(), naive.count()) << "n " << length << ", after " << i + 1;
    }
  }
}

TEST(WindowedCount, AnOutageCountsEveryEventThatItCost) {
  for (const std::int64_t failures : {0L, 1L, 7L, 64L, 65L, 1'000'000'000L}) {
    WindowedCount at_once(64), one_by_one(64);
    at_once.Push(true);
    one_by_one.Push(true);
    at_once.PushFailures(failures);
    for (std::int64_t i = 0; i < std::min<std::int64_t>(failures, 200); ++i) one_by_one.Push(true);
    EXPECT_EQ(at_once.count(), one_by_one.count()) << failures;
  }
  WindowedCount none(64);
  none.PushFailures(-1);
  EXPECT_EQ(none.count(), 0);
}

TEST(WindowedCount, ALengthOutOfRangeIsClamped) {
  EXPECT_EQ(CountAfter(0, 0b1, 1), 1);
  EXPECT_EQ(CountAfter(-5, 0b01, 2), 0);
  WindowedCount longest(1'000);
  longest.PushFailures(1'000);
  longest.Push(true);
  EXPECT_EQ(longest.count(), WindowedCount::kLongest);
}

}  // namespace
}  // namespace flexarm
