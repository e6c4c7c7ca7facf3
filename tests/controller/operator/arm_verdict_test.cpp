#include "controller/operator/arm_verdict.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <nlohmann/json.hpp>

namespace flexarm {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;
using testing::Not;
using Result = ArmVerdict::Result;

constexpr std::array kResults = {Result::kChecking, Result::kPassed, Result::kForced,
                                 Result::kFailed};

ArmVerdict VerdictOf(Result result) {
  ArmVerdict verdict{.result = result, .findings = {}};
  if (result != Result::kPassed) {
    verdict.findings = {{.name = "preempt-rt", .text = "none", .remedy = "install it"},
                        {.name = "isolation", .text = "no", .remedy = "isolate", .advice = true}};
  }
  return verdict;
}

// The whole table, written out independently of the code: 4 results of the host, 4 of the design,
// simulated or wired, with and without each of the two overrides.
TEST(ArmVerdict, EveryCombinationIsAllowedOrRefusedAsDocumented) {
  int allowed = 0;
  for (const Result host : kResults) {
    for (const Result design : kResults) {
      for (unsigned bits = 0; bits < 8; ++bits) {
        const bool simulated = (bits & 1) != 0, host_override = (bits & 2) != 0,
                   design_override = (bits & 4) != 0;
        std::vector<Override> overrides;
        if (host_override) overrides.push_back({.condition = "host", .reason = "r"});
        if (design_override) overrides.push_back({.condition = "design", .reason = "r"});
        const std::vector<UnmetCondition> unmet =
            UnmetToArm(VerdictOf(host), VerdictOf(design), simulated);
        const ConditionDecision decision = Judge(unmet, overrides);

        const bool host_holds = simulated || host == Result::kPassed;
        const bool design_holds =
            design == Result::kPassed || (design == Result::kForced && simulated);
        const bool host_ok = host_holds || host_override;
        const bool design_ok = design_holds || (design == Result::kForced && design_override);
        EXPECT_EQ(decision.refused == nullptr, host_ok && design_ok)
            << static_cast<int>(host) << ' ' << static_cast<int>(design) << ' ' << bits;
        if (decision.refused != nullptr) continue;
        ++allowed;
        EXPECT_EQ(decision.used.size(), (host_holds ? 0u : 1u) + (design_holds ? 0u : 1u));
      }
    }
  }
  // Simulated: any of 4 hosts, 2 designs, 4 pairs of overrides. Wired, with a sound design: 4 pairs
  // on a good machine, 2 on each of three others; with a forced one 2 and 1.
  EXPECT_EQ(allowed, 32 + (4 + 6) + (2 + 3));
}

TEST(ArmVerdict, ARefusalNamesWhatWasFoundAndTheRemedy) {
  const auto host = UnmetToArm(VerdictOf(Result::kFailed), VerdictOf(Result::kPassed), false);
  ASSERT_EQ(host.size(), 1u);
  EXPECT_EQ(host[0].refusal, "host-not-ready");
  EXPECT_THAT(host[0].found, HasSubstr("preempt-rt: none"));
  EXPECT_THAT(host[0].found, Not(HasSubstr("isolation"))) << "advice does not refuse";
  EXPECT_THAT(host[0].remedy, HasSubstr("install it"));
  EXPECT_THAT(host[0].remedy, HasSubstr("--override-host"));

  const auto forced = UnmetToArm(VerdictOf(Result::kPassed), VerdictOf(Result::kForced), false);
  ASSERT_EQ(forced.size(), 1u);
  EXPECT_EQ(forced[0].refusal, "design-forced");
  EXPECT_THAT(forced[0].remedy, HasSubstr("--override-design"));

  const auto rejected = UnmetToArm({}, VerdictOf(Result::kFailed), true);
  ASSERT_EQ(rejected.size(), 1u);
  EXPECT_EQ(rejected[0].refusal, "design-rejected");
  EXPECT_THAT(rejected[0].remedy, Not(HasSubstr("--override")));

  const auto unknown = UnmetToArm({}, VerdictOf(Result::kPassed), false);
  ASSERT_EQ(unknown.size(), 1u);
  EXPECT_EQ(unknown[0].refusal, "host-checking");
}

TEST(ArmVerdict, TheStatusNamesVerdictAndFindings) {
  EXPECT_EQ(HostJson({}), Json({{"verdict", "checking"}, {"findings", Json::array()}}));
  EXPECT_EQ(HostJson(VerdictOf(Result::kPassed))["verdict"], "ready");
  const Json failed = HostJson(VerdictOf(Result::kFailed));
  EXPECT_EQ(failed["verdict"], "not-ready");
  ASSERT_EQ(failed["findings"].size(), 2u);
  EXPECT_EQ(failed["findings"][1],
            Json({{"name", "isolation"}, {"text", "no"}, {"remedy", "isolate"}, {"advice", true}}));
  EXPECT_EQ(DesignJson(VerdictOf(Result::kPassed))["verdict"], "sound");
  EXPECT_EQ(DesignJson(VerdictOf(Result::kForced))["verdict"], "forced");
  EXPECT_EQ(DesignJson(VerdictOf(Result::kFailed))["verdict"], "rejected");
  EXPECT_EQ(DesignJson({})["verdict"], "rejected") << "not known is not sound";
}

}  // namespace
}  // namespace flexarm
