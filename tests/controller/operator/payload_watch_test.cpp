#include "controller/operator/payload_watch.h"

#include <gtest/gtest.h>

namespace flexarm {
namespace {

std::uint32_t Take(PayloadWatch* watch, std::uint32_t doubts,
                   SafetyState state = SafetyState::kRunning) {
  StepInput input{};
  input.safety_state = state;
  StepOutput output{};
  output.payload_doubts = doubts;
  return watch->Take(input, output);
}

TEST(PayloadWatch, TellsEachDoubtOnceARun) {
  PayloadWatch watch;
  EXPECT_EQ(Take(&watch, 0), 0u);
  EXPECT_EQ(Take(&watch, kPayloadAtBound), kPayloadAtBound);
  EXPECT_EQ(Take(&watch, kPayloadAtBound), 0u) << "said already";
  EXPECT_EQ(Take(&watch, kPayloadAtBound | kPayloadNotFound), kPayloadNotFound);
  EXPECT_EQ(Take(&watch, kPayloadAtBound, SafetyState::kArmed), 0u) << "nothing runs";
  EXPECT_EQ(Take(&watch, kPayloadAtBound), kPayloadAtBound) << "the next run";
}

TEST(PayloadWatch, EveryDoubtHasAName) {
  std::uint32_t named = 0;
  for (const PayloadWarning& warning : kPayloadWarnings) named |= warning.doubt;
  EXPECT_EQ(named, kPayloadAtBound | kPayloadModelMismatch | kPayloadNotFound);
}

}  // namespace
}  // namespace flexarm
