#include "controller/host/arm_verdicts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace flexarm {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using Result = ArmVerdict::Result;

HostCheck Check(const std::string& name, bool ok, bool advice) {
  return {.name = name,
          .ok = ok,
          .advice = advice,
          .value = "as found",
          .required = "as needed",
          .remedy = ok ? "" : "mend it"};
}

TEST(ArmVerdicts, AReadyMachineHasNoFindings) {
  const ArmVerdict verdict = HostVerdictOf({Check("preempt-rt", true, false)}, true);
  EXPECT_EQ(verdict.result, Result::kPassed);
  EXPECT_THAT(verdict.findings, IsEmpty());
}

TEST(ArmVerdicts, ACheckThatFailsIsAFindingAndAdviceDoesNotCount) {
  const std::vector<HostCheck> checks{Check("preempt-rt", true, false),
                                      Check("cpu-isolation", false, true)};
  const ArmVerdict advised = HostVerdictOf(checks, true);
  EXPECT_EQ(advised.result, Result::kPassed);
  ASSERT_EQ(advised.findings.size(), 1u);
  EXPECT_TRUE(advised.findings[0].advice);

  const ArmVerdict failed = HostVerdictOf({Check("preempt-rt", false, false)}, true);
  EXPECT_EQ(failed.result, Result::kFailed);
  ASSERT_EQ(failed.findings.size(), 1u);
  EXPECT_EQ(failed.findings[0], (Finding{.name = "preempt-rt",
                                         .text = "as found, required: as needed",
                                         .remedy = "mend it",
                                         .advice = false}));
}

TEST(ArmVerdicts, NoMachineIsReadyForADaemonWithoutRealTime) {
  const ArmVerdict verdict = HostVerdictOf({Check("preempt-rt", true, false)}, false);
  EXPECT_EQ(verdict.result, Result::kFailed);
  ASSERT_EQ(verdict.findings.size(), 1u);
  EXPECT_THAT(verdict.findings[0].text, HasSubstr("--without-realtime"));
}

TEST(ArmVerdicts, ADesignBringsWhatItsChecksFound) {
  DesignVerdict design{
      .result = DesignVerdict::Result::kSound, .checks = {}, .robustness = {}, .found = {}};
  EXPECT_EQ(DesignVerdictOf(design).result, Result::kPassed);
  EXPECT_THAT(DesignVerdictOf(design).findings, IsEmpty());
  design.found = "gain-margin-up = 1";
  design.result = DesignVerdict::Result::kForced;
  EXPECT_EQ(DesignVerdictOf(design).result, Result::kForced);
  design.result = DesignVerdict::Result::kRejected;
  const ArmVerdict verdict = DesignVerdictOf(design);
  EXPECT_EQ(verdict.result, Result::kFailed);
  ASSERT_EQ(verdict.findings.size(), 1u);
  EXPECT_EQ(verdict.findings[0].text, "gain-margin-up = 1");
  EXPECT_THAT(verdict.findings[0].remedy, HasSubstr("flexarm design"));
}

}  // namespace
}  // namespace flexarm
