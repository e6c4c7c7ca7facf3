#include "controller/operator/switch_proof_record.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace flexarm {
namespace {

using testing::HasSubstr;

constexpr std::int64_t kProved_s = 1'790'000'000;
constexpr std::int64_t kDay_s = 86'400;
constexpr double kValidDays = 90.0;

std::optional<GpiodConfig> Lines() {
  return GpiodConfig{.chip = "gpiochip0", .input = {0, 1, 2, 3, 4, 5}, .relay = 6, .pump = 7};
}

std::string Why(const std::optional<GpiodConfig>& lines, std::int64_t now_s) {
  return WhyNoProof(SwitchProofText(Lines(), kProved_s), lines, kValidDays, now_s);
}

TEST(SwitchProofRecord, HoldsForItsLinesAndItsDays) {
  EXPECT_EQ(Why(Lines(), kProved_s), "");
  EXPECT_EQ(Why(Lines(), kProved_s + 90 * kDay_s), "");
  EXPECT_THAT(Why(Lines(), kProved_s + 90 * kDay_s + 1), HasSubstr("90 days ago"));
  EXPECT_EQ(Why(Lines(), kProved_s - 60), "") << "a clock that was corrected";
  EXPECT_THAT(Why(Lines(), kProved_s - 61), HasSubstr("in the future"));
}

TEST(SwitchProofRecord, AnyOtherLineNeedsAnotherProof) {
  for (std::size_t i = 0; i < kLines; ++i) {
    std::optional<GpiodConfig> lines = Lines();
    lines->input[i] += 10;
    EXPECT_THAT(Why(lines, kProved_s), HasSubstr("other lines")) << i;
  }
  std::optional<GpiodConfig> lines = Lines();
  lines->chip = "gpiochip1";
  EXPECT_THAT(Why(lines, kProved_s), HasSubstr("other lines"));
  lines = Lines();
  lines->relay = 8;
  EXPECT_THAT(Why(lines, kProved_s), HasSubstr("other lines"));
  lines = Lines();
  lines->pump = 8;
  EXPECT_THAT(Why(lines, kProved_s), HasSubstr("other lines"));
  EXPECT_THAT(Why(std::nullopt, kProved_s), HasSubstr("other lines")) << "practice is no proof";
}

TEST(SwitchProofRecord, WhatIsNoSuchFileIsNoProof) {
  const std::string whole = SwitchProofText(Lines(), kProved_s);
  for (const std::string& text :
       {std::string(), std::string("{}"), std::string("[1]"), whole.substr(0, whole.size() / 2),
        std::string("{\"flexarm\":\"switch-proof\",\"version\":2,\"proved_unix_s\":1}"),
        std::string("{\"flexarm\":\"switch-proof\",\"version\":1,\"proved_unix_s\":\"now\"}"),
        std::string("\xff\xfe")}) {
    EXPECT_THAT(WhyNoProof(text, Lines(), kValidDays, kProved_s), HasSubstr("cannot be read"))
        << text;
  }
}

}  // namespace
}  // namespace flexarm
