#include "controller/operator/payload_warnings.h"

#include <gtest/gtest.h>

namespace flexarm {
namespace {

std::uint32_t Take(PayloadWarnings* watch, std::uint32_t warnings,
                   SafetyState state = SafetyState::kRunning) {
  StepInput input{};
  input.safety_state = state;
  StepOutput output{};
  output.payload_warnings = warnings;
  return watch->Take(input, output);
}

TEST(PayloadWarnings, ReportsEachWarningOnceARun) {
  PayloadWarnings watch;
  EXPECT_EQ(Take(&watch, 0), 0u);
  EXPECT_EQ(Take(&watch, kPayloadAtBound), kPayloadAtBound);
  EXPECT_EQ(Take(&watch, kPayloadAtBound), 0u) << "said already";
  EXPECT_EQ(Take(&watch, kPayloadAtBound | kPayloadNotObservable), kPayloadNotObservable);
  EXPECT_EQ(Take(&watch, kPayloadAtBound, SafetyState::kArmed), 0u) << "nothing runs";
  EXPECT_EQ(Take(&watch, kPayloadAtBound), kPayloadAtBound) << "the next run";
}

TEST(PayloadWarnings, EveryWarningHasAName) {
  std::uint32_t named = 0;
  for (const PayloadWarningText& warning : kPayloadWarnings) named |= warning.bit;
  EXPECT_EQ(named, kPayloadAtBound | kPayloadModelMismatch | kPayloadNotObservable);
}

}  // namespace
}  // namespace flexarm
