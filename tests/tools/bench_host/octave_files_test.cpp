#include "tools/bench_host/octave_files.h"

#include <gtest/gtest.h>

#include "tests/support/thesis_rig.h"

namespace flexarm {
namespace {

std::string Line(const char* kind, double first) {
  std::string line = kind;
  for (std::size_t i = 0; i < SolverProblem::kStates; ++i) {
    line += ' ' + std::to_string(first + static_cast<double>(i));
  }
  return line + '\n';
}

std::string Race(const char* head, std::size_t states) {
  std::string text = head;
  for (std::size_t i = 0; i < states; ++i) text += Line("y", static_cast<double>(i));
  return text;
}

TEST(OctaveFiles, ARaceIsRead) {
  const OctaveRace race =
      ParseOctaveRace(Line("rate", 1.0) + Race("race 1e-3 2.5 4711\n", SolverProblem::kInstants) +
                      Race("race 1e-4 3.5 9000\n", SolverProblem::kInstants));
  ASSERT_EQ(race.rates.size(), 1U);
  EXPECT_DOUBLE_EQ(race.rates[0][2], 3.0);
  ASSERT_EQ(race.entries.size(), 2U);
  EXPECT_DOUBLE_EQ(race.entries[0].tolerance, 1e-3);
  EXPECT_DOUBLE_EQ(race.entries[0].time_s, 2.5);
  EXPECT_EQ(race.entries[1].calls, 9000);
  EXPECT_DOUBLE_EQ(race.entries[1].motion[19][0], 19.0);
}

TEST(OctaveFiles, OtherTextIsRefused) {
  for (const std::string& text :
       {std::string("rate 1 2 3\n"), std::string("error: parse\n"), Line("y", 0.0),
        Race("race 1e-3 2.5 4711\n", SolverProblem::kInstants - 1), std::string("race 1\n")}) {
    EXPECT_THROW(ParseOctaveRace(text), std::runtime_error) << text;
  }
}

TEST(OctaveFiles, TheDataHaveEveryConstantThatTheScriptReads) {
  const SolverProblem problem(ThesisRig(), {30.0, 6.0});
  const std::string data = ArmDataText(problem, {SolverProblem::State{}}, {1e-3});
  const std::string script = ArmRateFile();
  for (std::size_t at = script.find("arm."); at != std::string::npos;
       at = script.find("arm.", at + 1)) {
    const std::size_t end = script.find_first_not_of(
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789", at + 4);
    const std::string name = script.substr(at, end - at);
    if (at > 0 && (std::isalnum(static_cast<unsigned char>(script[at - 1])) != 0)) continue;
    if (name == "arm." || name == "arm.torque" || script.substr(at, 8) == "arm_mode") continue;
    EXPECT_NE(data.find(name + " = "), std::string::npos) << name;
  }
  EXPECT_NE(data.find("arm.L1 = 0.8"), std::string::npos);
}

}  // namespace
}  // namespace flexarm
