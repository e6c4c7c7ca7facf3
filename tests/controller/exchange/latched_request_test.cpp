#include "controller/exchange/latched_request.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <thread>

namespace flexarm {
namespace {

TEST(LatchedRequest, IsTakenOnceAndNoneIsSetAtFirst) {
  LatchedRequest request;
  EXPECT_EQ(request.Take(), 0u);
  request.Set(7);
  EXPECT_EQ(request.Take(), 7u);
  EXPECT_EQ(request.Take(), 0u) << "it was taken";
}

TEST(LatchedRequest, ANewerOneReplacesOneThatWaits) {
  LatchedRequest request;
  request.Set(1);
  request.Set(2);
  EXPECT_EQ(request.Take(), 2u);
  EXPECT_EQ(request.Take(), 0u);
  request.Set(3);
  EXPECT_EQ(request.Take(), 3u);
}

// What the writer wrote before a request belongs to it: here a number beside each. Run with the
// thread sanitizer too.
TEST(LatchedRequest, TwoThreadsLoseNotTheLastAndSeeNoneTwice) {
  constexpr std::uint32_t kLast = 20'000;
  LatchedRequest request;
  std::array<std::uint32_t, kLast + 1> beside{};
  std::thread writer([&] {
    for (std::uint32_t i = 1; i <= kLast; ++i) {
      beside[i] = i * 3;
      request.Set(i);
    }
  });
  std::uint32_t taken = 0;
  std::uint64_t wrong = 0;
  while (taken < kLast) {
    const std::uint32_t number = request.Take();
    if (number == 0) continue;
    wrong += number <= taken || beside[number] != number * 3;
    taken = number;
  }
  writer.join();
  EXPECT_EQ(wrong, 0u);
  EXPECT_EQ(request.Take(), 0u);
}

}  // namespace
}  // namespace flexarm
