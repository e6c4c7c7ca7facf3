#include "hal/sim/frame_loss.h"

#include <gtest/gtest.h>

#include <vector>

namespace flexarm {
namespace {

std::vector<bool> Losses(double fraction, std::uint64_t seed, int frames) {
  FrameLoss loss(fraction, seed);
  std::vector<bool> lost;
  for (int k = 0; k < frames; ++k) lost.push_back(loss.Next());
  return lost;
}

// The fraction of a Markov chain: between two losses are 1 / q frames on average, q = p / (1 - p),
// so a loss occurs every 1 + 1/q = 1/p frames. Of 40 000 frames with p = 0.1 the count is 4000 +-
// 55 (renewal: variance n p^3 (1 - q) / q^2); five sigma.
TEST(FrameLoss, LosesTheFractionAndNeverTwoInARow) {
  const std::vector<bool> lost = Losses(0.1, 1, 40'000);
  int count = 0;
  for (std::size_t k = 0; k < lost.size(); ++k) {
    count += lost[k] ? 1 : 0;
    if (k > 0) {
      EXPECT_FALSE(lost[k] && lost[k - 1]) << k;
    }
  }
  EXPECT_NEAR(count, 4000, 5 * 55);
}

TEST(FrameLoss, LosesNothingAtFractionZero) {
  for (const bool lost : Losses(0.0, 1, 1000)) EXPECT_FALSE(lost);
}

TEST(FrameLoss, IsIdenticalForTheSameSeedOnly) {
  EXPECT_EQ(Losses(0.1, 3, 1000), Losses(0.1, 3, 1000));
  EXPECT_NE(Losses(0.1, 3, 1000), Losses(0.1, 4, 1000));
}

}  // namespace
}  // namespace flexarm
