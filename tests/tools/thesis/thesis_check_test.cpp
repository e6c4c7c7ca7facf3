#include "tools/thesis/thesis_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

// The config for which independent code computed the reference numbers below: exact section
// matching and dynamic stiffness, and the closed forms of (3.8) to (3.11).
RigConfig ReferenceConfig() {
  RigConfig config{};
  config.arm = ThesisRig();
  config.arm.link1_tip_inertia = Link1TipInertia::kMotor;
  config.arm.joint2_backlash.restitution_slope_s_per_rad = 0.2;
  return config;
}

const Statement& About(const std::vector<Statement>& statements, const std::string& words) {
  for (const Statement& s : statements) {
    if (s.thesis.find(words) != std::string::npos) return s;
  }
  throw std::out_of_range(words);
}

void ExpectSaid(const Statement& statement, const std::vector<std::string>& figures) {
  for (const std::string& figure : figures) {
    EXPECT_NE(statement.model.find(figure), std::string::npos)
        << figure << " is not in: " << statement.model;
  }
}

TEST(Chapter3Statements, GiveTheReferenceNumbers) {
  const std::vector<Statement> s = Chapter3Statements(ReferenceConfig());
  // Link 1, mode 1: 0.0858 N m at 1 mm; 0.42905 N m and, slipping, 0.52121 Hz at 5 mm.
  ExpectSaid(About(s, "clamped moment"), {"0.0858 N m", "0.429 N m", "0.521 Hz"});
  // zeta_k = xi (beta_k L)^2 / 2 with beta L of the links' modes; as printed 52 times smaller.
  ExpectSaid(About(s, "damping ratios"), {"0.00786 and 0.119", "0.0318 and 0.256", "52.0 times"});
  // (4 - 5 s) / (2 - 2 s) at s = zeta v = 0.1, 0.5 and 0.9.
  ExpectSaid(About(s, "(3.11) takes"), {"1.94 times", "1.50 times"});
  ExpectSaid(About(s, "as a damper"), {"-2.50 times"});
  // The linearised arm is unstable from 5.22735 rad/s on with M = 2 and 4 and either linearisation;
  // the reference list says 5.228.
  ExpectSaid(About(s, "keeps its length"), {"6.62 to", "5.227 rad/s"});
  // M = 2 compared with M = 12; comparison with the exact frequencies gives .019 .106 .490 .048 %.
  ExpectSaid(About(s, "the M that are kept"), {"0.019, 0.11, 0.49, 0.048 %"});
}

TEST(BeamStatements, GiveTheReferenceNumbers) {
  const std::vector<Statement> s = BeamStatements(ReferenceConfig().arm);
  // Bare link 2 with N = 10: -0.457 -1.564 -2.550 -3.565 %; the claim needs N >= 31, 86 for four.
  ExpectSaid(About(s, "transfer matrix"),
             {"-0.457, -1.56, -2.55, -3.5", "31 parts for the first", "86 for 4; if pinned"});
  EXPECT_EQ(About(s, "concentrated moment").verdict, Verdict::kDoesNot);
  EXPECT_EQ(About(s, "one beta").verdict, Verdict::kDoesNot);
}

TEST(Chapter4Statements, GiveTheReferenceNumbers) {
  const std::vector<Statement> s = Chapter4Statements(ReferenceConfig());
  // Uniform beam: (L^3 / 3EI) / (L^2 / K) = K L / 3EI.
  ExpectSaid(About(s, "equally flexible"), {"11.1 times", "27.1 times"});
  ExpectSaid(About(s, "3.0 mm thick"), {"30.0 mm by 3.175 mm"});
  ExpectSaid(About(s, "Young's modulus"), {"from 6.62 to"});
  // Tip at 3 s: (1.690807100, 0.145161223) m with two modes, (1.690798637, 0.145217013) with four.
  ExpectSaid(About(s, "agree well"), {"0.056 mm apart"});
}

TEST(Chapter6Statements, HoldWhereTheReferenceHolds) {
  const std::vector<Statement> s = Chapter6Statements(ReferenceConfig());
  for (const char* words : {"small perturbations", "relaxed condition", "mean power",
                            "stronger than any other", "two modes a link dominate"}) {
    EXPECT_EQ(About(s, words).verdict, Verdict::kHolds) << words;
  }
  EXPECT_NE(About(s, "right angles").verdict, Verdict::kHolds);
  // Contribution of the first mode at rest, with modes scaled by mass and by length.
  ExpectSaid(About(s, "physical meaning"),
             {"99.50 % with modes of 1 kg", "95.37 % with int psi^2"});
}

TEST(ThesisCheckPage, HasARowForEachStatementAndCountsTheVerdicts) {
  RigConfig config{};
  config.rig_name = "a rig";
  const std::string page = ThesisCheckPage(
      config, {{"3.2", "one", "1", Verdict::kHolds}, {"4.3", "two", "2", Verdict::kDoesNot}});
  EXPECT_NE(page.find("`a rig`"), std::string::npos);
  EXPECT_NE(page.find("| 3.2 | one | 1 | holds |\n| 4.3 | two | 2 | does not hold |"),
            std::string::npos);
  EXPECT_NE(page.find("holds: 1, holds in part: 0, depends on the excitation: 0, does not hold: 1"),
            std::string::npos);
}

}  // namespace
}  // namespace flexarm
