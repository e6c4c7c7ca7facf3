// The person at the rig, played: which readings prove the switches, and which name a wrong wire.

#include "controller/commissioning/switch_proof.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "hal/line_names.h"

namespace flexarm {
namespace {

using testing::HasSubstr;

constexpr double kPeriod_s = 0.02;
constexpr int kPatience = static_cast<int>(SwitchProof::kPatience_s / kPeriod_s);

// The line away from its healthy level.
LineLevels Away(Line line) { return kHealthyLevels ^ LineBit(line); }

void Hold(SwitchProof& proof, LineLevels levels, int samples = 10) {
  for (int i = 0; i < samples; ++i) proof.Take(levels);
}

void Operate(SwitchProof& proof, Line line) {
  Hold(proof, kHealthyLevels);
  Hold(proof, Away(line));
  Hold(proof, kHealthyLevels);
}

TEST(SwitchProof, EachStepDoneProvesTheSwitches) {
  SwitchProof proof(kPeriod_s);
  for (std::size_t i = 0; i < kProofSteps.size(); ++i) {
    EXPECT_EQ(proof.step(), i);
    EXPECT_FALSE(proof.done());
    Hold(proof, kHealthyLevels);
    EXPECT_EQ(proof.step(), i) << "nothing has been operated";
    Hold(proof, Away(kProofSteps[i].line));
    EXPECT_EQ(proof.step(), i) << "not released yet";
    Hold(proof, kHealthyLevels);
  }
  EXPECT_TRUE(proof.done());
  EXPECT_FALSE(proof.failed());
  EXPECT_EQ(proof.Text(), "");
}

// Every line in the place of the one that is asked for: none counts, and the text names it.
TEST(SwitchProof, AnotherLineDoesNotCount) {
  for (std::size_t asked = 0; asked < kProofSteps.size(); ++asked) {
    for (int other = 0; other < kLines; ++other) {
      const auto line = static_cast<Line>(other);
      if (line == kProofSteps[asked].line) continue;
      SwitchProof proof(kPeriod_s);
      for (std::size_t i = 0; i < asked; ++i) Operate(proof, kProofSteps[i].line);
      Hold(proof, Away(line));
      EXPECT_THAT(proof.Text(), HasSubstr("where nothing but"));
      Hold(proof, kHealthyLevels);
      EXPECT_EQ(proof.step(), asked);
      Operate(proof, kProofSteps[asked].line);
      EXPECT_EQ(proof.step(), asked + 1) << "the right line still counts";
    }
  }
}

// Two inputs connected: both open, and what the asked one does is not its own doing.
TEST(SwitchProof, TwoLinesTogetherDoNotCount) {
  SwitchProof proof(kPeriod_s);
  const LineLevels both = Away(Line::kLimit1Low) & Away(Line::kLimit1High);
  Hold(proof, both);
  Hold(proof, kHealthyLevels);
  EXPECT_EQ(proof.step(), 0U);
  Hold(proof, Away(Line::kLimit1Low));
  Hold(proof, both);
  Hold(proof, Away(Line::kLimit1Low));
  Hold(proof, both);
  Hold(proof, kHealthyLevels);
  EXPECT_EQ(proof.step(), 0U);
}

// An input without a pull-down reads an unplugged connector as closed: nothing is seen.
TEST(SwitchProof, AConnectorWhoseUnpluggingIsNotSeenFails) {
  SwitchProof proof(kPeriod_s);
  Operate(proof, Line::kLimit1Low);
  Hold(proof, kHealthyLevels, kPatience - 20);
  EXPECT_FALSE(proof.failed());
  Hold(proof, kHealthyLevels, 20);
  EXPECT_TRUE(proof.failed());
  EXPECT_THAT(proof.Text(), HasSubstr("limit-1-low did not change"));
  EXPECT_THAT(proof.Text(), HasSubstr("no pull-down"));
  Operate(proof, Line::kLimit1Low);
  EXPECT_TRUE(proof.failed()) << "the proof has ended";
  EXPECT_EQ(proof.step(), 1U);
}

TEST(SwitchProof, ALineThatStaysAwayFails) {
  SwitchProof proof(kPeriod_s);
  Hold(proof, kHealthyLevels);
  Hold(proof, Away(Line::kLimit1Low), kPatience + 1);
  EXPECT_TRUE(proof.failed());
  EXPECT_THAT(proof.Text(), HasSubstr("did not come back"));
}

// A line that is not healthy from the beginning is named, and not mistaken for the one asked for.
TEST(SwitchProof, ALineThatIsOpenAtTheBeginningIsNamed) {
  SwitchProof proof(kPeriod_s);
  Hold(proof, Away(Line::kEmergencyStop));
  EXPECT_THAT(proof.Text(), HasSubstr("emergency-stop opened"));
  EXPECT_EQ(proof.step(), 0U);
}

// A switch that is open already has not been operated.
TEST(SwitchProof, ALineCountsOnlyFromItsHealthyLevel) {
  SwitchProof proof(kPeriod_s);
  Hold(proof, Away(Line::kLimit1Low));
  EXPECT_EQ(proof.Text(), "limit-1-low is not closed: close it first");
  Hold(proof, kHealthyLevels);
  EXPECT_EQ(proof.step(), 0U);
  Operate(proof, Line::kLimit1Low);
  EXPECT_EQ(proof.step(), 1U);
}

// What is done before the patience is over gives the next act all of it.
TEST(SwitchProof, EachActHasItsOwnPatience) {
  SwitchProof proof(kPeriod_s);
  Hold(proof, kHealthyLevels, kPatience - 1);
  EXPECT_FALSE(proof.failed());
  Hold(proof, Away(Line::kLimit1Low), 1 + kPatience - 1);
  EXPECT_FALSE(proof.failed());
  Hold(proof, kHealthyLevels, 1 + kPatience - 1);
  EXPECT_EQ(proof.step(), 1U);
  EXPECT_FALSE(proof.failed());
  Hold(proof, kHealthyLevels, 1);
  EXPECT_TRUE(proof.failed());
}

TEST(SwitchProof, EveryWrongLineIsNamed) {
  SwitchProof proof(kPeriod_s);
  Operate(proof, Line::kLimit1Low);
  Operate(proof, Line::kLimit1Low);
  ASSERT_EQ(kProofSteps[proof.step()].line, Line::kLimit1High);
  Hold(proof, Away(Line::kLimit1Low) & Away(Line::kEmergencyStop));
  EXPECT_THAT(proof.Text(), testing::StartsWith("limit-1-low, emergency-stop opened where"));
}

// Levels have bits that are no line.
TEST(SwitchProof, OtherBitsAreNoLines) {
  const LineLevels others = static_cast<LineLevels>(~((1U << kLines) - 1U));
  SwitchProof proof(kPeriod_s);
  Hold(proof, kHealthyLevels | others);
  Hold(proof, Away(Line::kLimit1Low) | others);
  Hold(proof, kHealthyLevels | others);
  EXPECT_EQ(proof.step(), 1U);
}

TEST(SwitchProof, OnlyAConnectorThatIsNotSeenHasNoPullDown) {
  SwitchProof operated(kPeriod_s);
  Hold(operated, kHealthyLevels, kPatience);
  EXPECT_EQ(operated.Text(),
            "limit-1-low did not change within 120 s (operate limit-1-low by hand, then release "
            "it)");
  SwitchProof unplugged(kPeriod_s);
  Operate(unplugged, Line::kLimit1Low);
  Hold(unplugged, Away(Line::kLimit1Low), kPatience + 1);
  EXPECT_EQ(unplugged.Text(),
            "limit-1-low did not come back within 120 s (unplug the connector of limit-1-low, then "
            "plug it in again)");
}

TEST(SwitchProof, EachActAsksForWhatToDoThen) {
  SwitchProof proof(kPeriod_s);
  Hold(proof, kHealthyLevels);
  EXPECT_EQ(proof.Text(), "operate limit-1-low by hand, then release it");
  Hold(proof, Away(Line::kLimit1Low));
  EXPECT_EQ(proof.Text(), "limit-1-low is seen: now undo it");
  Hold(proof, kHealthyLevels);
  EXPECT_EQ(proof.Text(), "unplug the connector of limit-1-low, then plug it in again");
  while (proof.step() < kProofSteps.size() - 1) Operate(proof, kProofSteps[proof.step()].line);
  EXPECT_EQ(proof.Text(), "press and release reset-button");
}

// Each switch at its own input, and that its wire may break; the button last, for the reset.
TEST(SwitchProof, EverySwitchIsOperatedAndUnpluggedThenTheButtonPressed) {
  std::string steps;
  for (const ProofStep& step : kProofSteps) {
    steps += std::string(ToString(step.act)) + " " + ToString(step.line) + "\n";
  }
  EXPECT_EQ(steps,
            "operate limit-1-low\nunplug limit-1-low\noperate limit-1-high\nunplug limit-1-high\n"
            "operate limit-2-low\nunplug limit-2-low\noperate limit-2-high\nunplug limit-2-high\n"
            "operate emergency-stop\nunplug emergency-stop\npress reset-button\n");
}

TEST(SwitchProof, ActsHaveNames) {
  EXPECT_STREQ(ToString(ProofAct::kOperate), "operate");
  EXPECT_STREQ(ToString(ProofAct::kUnplug), "unplug");
  EXPECT_STREQ(ToString(ProofAct::kPress), "press");
  EXPECT_STREQ(ToString(static_cast<ProofAct>(3)), "unknown");
}

}  // namespace
}  // namespace flexarm
