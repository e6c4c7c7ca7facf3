#include "controller/design/design_verdict.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "controller/design/design_controller.h"
#include "controller/design/run_design.h"
#include "tests/controller/law/shipped_rig.h"

namespace flexarm {
namespace {

using testing::DoubleEq;
using testing::ElementsAre;
using testing::HasSubstr;
using Result = DesignVerdict::Result;

const DesignCheck& CheckOf(const DesignVerdict& verdict, const std::string& name) {
  return *std::find_if(verdict.checks.begin(), verdict.checks.end(),
                       [&name](const DesignCheck& check) { return check.name == name; });
}

// A loop that diverges: one sample of delay, not compensated.
struct UnstableRig {
  RigConfig config = ShippedRig({"controller.prediction=false"});
  Design design = DesignController(config);
};

TEST(DesignVerdict, EveryShippedRigIsSound) {
  int rigs = 0;
  for (const auto& file : std::filesystem::directory_iterator(FLEXARM_SOURCE_DIR "/config")) {
    if (file.path().extension() != ".toml") continue;
    ++rigs;
    const RigConfig config = LoadConfig(file.path());
    const DesignVerdict verdict = JudgeDesign(config, DesignFor(config));
    EXPECT_EQ(verdict.result, Result::kSound) << file.path() << ": " << verdict.found;
    EXPECT_EQ(verdict.found, "");
  }
  EXPECT_GE(rigs, 7);
}

TEST(DesignVerdict, EveryLawOfTheShippedRigIsSound) {
  for (const std::string& law : LawNames([](const LawRow&) { return true; })) {
    const RigConfig config = ShippedRig({"controller.name=" + law});
    const DesignVerdict verdict = JudgeDesign(config, DesignController(config));
    EXPECT_EQ(verdict.result, Result::kSound) << law << ": " << verdict.found;
  }
  const RigConfig config = ShippedRig({"estimator.name=ekf-payload"});
  EXPECT_EQ(JudgeDesign(config, DesignController(config)).result, Result::kSound);
}

TEST(DesignVerdict, AnUnstableLoopIsRejectedWithItsFiguresAndWhereItIsWorst) {
  const UnstableRig rig;
  const DesignVerdict verdict = JudgeDesign(rig.config, rig.design);
  EXPECT_EQ(verdict.result, Result::kRejected);
  EXPECT_THAT(verdict.found, HasSubstr("robustness-spectral-radius = 1."));
  EXPECT_THAT(verdict.found, HasSubstr("must be below 1"));
  EXPECT_THAT(verdict.found, HasSubstr("unstable with "));
  EXPECT_THAT(verdict.found, HasSubstr(" kg, elbow at "));
}

TEST(DesignVerdict, ThePayloadsAreThoseOfTheConfig) {
  EXPECT_THAT(CheckedPayloads_kg(ShippedRig().controller),
              ElementsAre(0.0, DoubleEq(0.01), DoubleEq(0.1), DoubleEq(0.2), 0.5, 1.0));
  const RigConfig config = ShippedRig({"controller.payload_range_kg=[0.1, 0.1]"});
  EXPECT_EQ(JudgeDesign(config, ShippedDesign()).robustness->cases.size(), 9u)
      << "one payload, three elbow angles, three gains";
  // This design is stable with 0.3 kg (0.9994) and unstable with 0.5 kg (1.0073).
  const auto with = [](const std::string& range) {
    const RigConfig rig =
        LoadConfig(FLEXARM_SOURCE_DIR "/config/quanser-2dsfl.toml",
                   {"controller.torque_weight=5", "controller.payload_range_kg=" + range});
    return JudgeDesign(rig, DesignController(rig));
  };
  EXPECT_EQ(with("[0.157, 0.3]").result, Result::kSound);
  const DesignVerdict heavy = with("[0.157, 0.5]");
  EXPECT_EQ(heavy.result, Result::kRejected);
  EXPECT_THAT(heavy.found, HasSubstr("unstable with 0.5 kg, elbow at 90 deg"));
}

TEST(DesignVerdict, AWaivedCheckIsForcedOnlyIfEveryFailedOneIsWaived) {
  UnstableRig rig;
  const DesignVerdict rejected = JudgeDesign(rig.config, rig.design);
  std::vector<std::string> failed;
  for (const DesignCheck& check : rejected.checks) {
    if (!check.passed()) failed.push_back(check.name);
  }
  ASSERT_GE(failed.size(), 2u);
  rig.design.checks = rejected.checks;
  for (DesignCheck& check : rig.design.checks) check.waived = !check.passed();
  const DesignVerdict forced = JudgeDesign(rig.config, rig.design);
  EXPECT_EQ(forced.result, Result::kForced);
  EXPECT_EQ(forced.found, rejected.found);
  EXPECT_EQ(forced.checks.size(), rejected.checks.size()) << "each check once";
  for (DesignCheck& check : rig.design.checks) {
    if (check.name == failed.front()) check.waived = false;
  }
  EXPECT_EQ(JudgeDesign(rig.config, rig.design).result, Result::kRejected);
}

// The file may say what it likes: the gains are judged as they are.
TEST(DesignVerdict, WhatAFileSaysOfTheRobustnessIsNotBelieved) {
  Design design = ShippedDesign();
  design.K *= -1.0;
  design.checks.push_back({"robustness-spectral-radius", 0.5, 1.0, true});
  const DesignVerdict verdict = JudgeDesign(ShippedRig(), design);
  EXPECT_EQ(verdict.result, Result::kRejected);
  EXPECT_GT(CheckOf(verdict, "robustness-spectral-radius").value, 1.0);
}

TEST(DesignVerdict, WhatIsNotANumberIsRejected) {
  Design design = ShippedDesign();
  design.K(0, 0) = std::numeric_limits<double>::quiet_NaN();
  const DesignVerdict verdict = JudgeDesign(ShippedRig(), design);
  EXPECT_EQ(verdict.result, Result::kRejected);
  EXPECT_THAT(verdict.found, HasSubstr("robustness-spectral-radius"));
  EXPECT_EQ(verdict.delay_margin_s(), 0.0);
}

TEST(DesignVerdict, AnArmThatCannotBeAnalysedIsRejected) {
  Design design = ShippedDesign();
  design.filter_A_rate.resize(0, 0);
  RigConfig config = ShippedRig({"loop.actuation_delay_ms=5"});
  const DesignVerdict verdict = JudgeDesign(config, design);
  EXPECT_EQ(verdict.result, Result::kRejected);
  EXPECT_FALSE(verdict.robustness);
  EXPECT_THAT(verdict.found, HasSubstr("not possible"));
  EXPECT_EQ(verdict.delay_margin_s(), 0.0);
}

}  // namespace
}  // namespace flexarm
