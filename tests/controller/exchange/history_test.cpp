#include "controller/exchange/history.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace flexarm {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

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

// Counts how often one is copied into another.
struct Counted {
  static inline int copies = 0;
  Counted() = default;
  explicit Counted(int n) : number(n) {}
  Counted(const Counted&) = default;
  Counted& operator=(const Counted& other) {
    number = other.number;
    ++copies;
    return *this;
  }
  int number = 0;
};

// A history is published every millisecond; of its values, which may be large, one is new.
TEST(History, FollowingCopiesOnlyWhatWasPushedSince) {
  History<Counted, 4> newer(Counted(0));
  History<Counted, 4> follower = newer;
  for (int lacks = 0; lacks <= 9; ++lacks) {
    for (int i = 0; i < lacks; ++i) newer.Push(lacks, Counted(i));
    Counted::copies = 0;
    follower.Follow(newer);
    EXPECT_EQ(Counted::copies, std::min(lacks, 4));
  }
}

template <int N>
std::vector<int> ValuesOf(const History<int, N>& history, std::int64_t after_ns,
                          std::int64_t until_ns) {
  std::vector<int> values;
  history.ForEach(after_ns, until_ns, [&values](int value) { values.push_back(value); });
  return values;
}

TEST(History, ShowsEachValueThatBeganInAnInterval) {
  History<int, 4> history(-1);
  for (int i = 1; i <= 3; ++i) history.Push(i * 100, i);
  EXPECT_THAT(ValuesOf(history, 100, 200), ElementsAre(2)) << "without its begin, with its end";
  EXPECT_THAT(ValuesOf(history, 99, 199), ElementsAre(1));
  EXPECT_THAT(ValuesOf(history, 100, 1000), UnorderedElementsAre(2, 3));
  EXPECT_THAT(ValuesOf(history, 300, 1000), IsEmpty());
}

TEST(History, AValueThatWasThereFromTheStartBeganInNoInterval) {
  const History<int, 4> history(-1);
  EXPECT_THAT(ValuesOf(history, INT64_MIN, INT64_MAX), IsEmpty());
  EXPECT_EQ(history.Newest().from_ns, INT64_MIN);
}

TEST(History, OfOneValueKeepsTheNewest) {
  History<int, 1> history(-1);
  EXPECT_EQ(history.At(0).value, -1);
  history.Push(100, 1);
  history.Push(200, 2);
  EXPECT_EQ(history.At(200).value, 2);
  EXPECT_EQ(history.At(100).value, 2) << "nothing older is stored";
}

}  // namespace
}  // namespace flexarm
