#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "config/config.h"
#include "tests/config/config_testing.h"

namespace flexarm {
namespace {

using ::testing::HasSubstr;

constexpr const char* kExperiment = R"(name = "switch"
duration_s = 6.0

[[doublet]]
start_s = 0.0
duration_s = 1.0
shape = "square"
move_deg = [30.0, 30.0]

[[doublet]]
start_s = 3.0
duration_s = 1.5
shape = "sine"
move_deg = [-30.0, 0.0]

[[sim_event]]
at_s = 0.5
line = "limit-1-high"
level = 0

[[sim_event]]
at_s = 1.5
freeze = "control"

[[sim_event]]
at_s = 2.5
kill = true
)";

constexpr const char* kMoves = R"(name = "moves"
duration_s = 6.0

[[doublet]]
start_s = 0.0
duration_s = 1.0
shape = "square"
move_deg = [30.0, 30.0]

[[move]]
start_s = 1.2
duration_s = 0.8
to_deg = [10.0, -5.0]

[[move]]
start_s = 2.6
duration_s = 1.4
to_deg = [0.0, 0.0]
)";

TEST(ExperimentFile, MovesAreReadWhole) {
  const Experiment e = ParseExperiment(kMoves, "e.toml");
  ASSERT_EQ(e.move.size(), 2U);
  EXPECT_EQ(e.move[0].start_s, 1.2);
  EXPECT_EQ(e.move[0].duration_s, 0.8);
  EXPECT_EQ(e.move[0].to_deg, (std::array{10.0, -5.0}));
}

TEST(ExperimentFile, MotionsAreDoubletsAndMovesInOrderOfTime) {
  Experiment e = ParseExperiment(kMoves, "e.toml");
  e.doublet[0].start_s = 4.5;
  const std::vector<Motion> motions = e.Motions();
  ASSERT_EQ(motions.size(), 3U);
  EXPECT_EQ(motions[0].start_s, 1.2);
  EXPECT_EQ(motions[1].start_s, 2.6);
  EXPECT_EQ(motions[1].duration_s, 1.4);
  EXPECT_EQ(motions[2].start_s, 4.5);
}

TEST(ExperimentFile, IsReadWhole) {
  const Experiment e = ParseExperiment(kExperiment, "e.toml");
  EXPECT_EQ(e.name, "switch");
  EXPECT_EQ(e.text, kExperiment);
  EXPECT_EQ(e.duration_s, 6.0);
  ASSERT_EQ(e.doublet.size(), 2U);
  EXPECT_EQ(e.doublet[1].shape, DoubletShape::kSine);
  EXPECT_EQ(e.doublet[1].duration_s, 1.5);
  EXPECT_EQ(e.doublet[1].move_deg, (std::array{-30.0, 0.0}));
  ASSERT_EQ(e.sim_event.size(), 3U);
  EXPECT_EQ(e.sim_event[0].line, Line::kLimit1High);
  EXPECT_EQ(e.sim_event[0].level, 0);
  EXPECT_EQ(e.sim_event[1].freeze, FreezeTarget::kControl);
  EXPECT_FALSE(e.sim_event[1].line.has_value());
  EXPECT_FALSE(e.sim_event[1].kill);
  EXPECT_TRUE(e.sim_event[2].kill);
}

TEST(ExperimentFile, NeedsNoRows) {
  EXPECT_NO_THROW(ParseExperiment("name = \"hold\"\nduration_s = 2\n", "e.toml"));
}

struct BrokenCase {
  std::string name;
  std::string from;
  std::string to;
  std::string key;
  std::string rule;
  std::string line_of = {};
  std::string text = kExperiment;
};

void PrintTo(const BrokenCase& c, std::ostream* out) { *out << c.name; }

class BrokenExperiment : public ::testing::TestWithParam<BrokenCase> {};

TEST_P(BrokenExperiment, IsReportedOnceWithLineKeyAndRule) {
  const BrokenCase& c = GetParam();
  const std::string text = Replaced(c.text, c.from, c.to);
  try {
    ParseExperiment(text, "e.toml");
    FAIL() << "was accepted";
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.problems().size(), 1U) << error.what();
    const ConfigProblem& problem = error.problems()[0];
    EXPECT_EQ(problem.file, "e.toml");
    EXPECT_EQ(problem.line, LineOf(text, c.line_of.empty() ? c.to : c.line_of));
    EXPECT_EQ(problem.key, c.key);
    EXPECT_THAT(problem.rule, HasSubstr(c.rule));
  }
}

const BrokenCase kBroken[] = {
    {"NoName", "name = \"switch\"", "", "name", "missing", "no line"},
    {"EmptyName", "name = \"switch\"", "name = \"\"", "name", "1 to 64 printable"},
    {"NoDuration", "duration_s = 6.0", "", "duration_s", "missing", "no line"},
    {"UnknownKey", "name = \"switch\"", "name = \"switch\"\nextends = \"a.toml\"", "extends",
     "unknown key"},
    {"UnknownKeyInARow", "start_s = 3.0", "start_s = 3.0\nmove = 1", "doublet[1].move",
     "unknown key"},
    {"UnknownShape", "shape = \"sine\"", "shape = \"ramp\"", "doublet[1].shape", "one of"},
    {"OneMove", "move_deg = [-30.0, 0.0]", "move_deg = [-30.0]", "doublet[1].move_deg",
     "an array of 2"},
    {"NegativeStart", "start_s = 0.0", "start_s = -1.0", "doublet[0].start_s", "0 .. 3600"},
    {"DoubletBeyondTheEnd", "duration_s = 1.5", "duration_s = 3.5", "doublet[1].duration_s",
     "must end inside the experiment"},
    {"DoubletsOverlap", "start_s = 3.0", "start_s = 0.9", "doublet[1].start_s", "do not overlap"},
    {"NoMoveDuration", "duration_s = 1.5", "duration_s = 0", "doublet[1].duration_s", "above 0"},
    {"WildMove", "move_deg = [-30.0, 0.0]", "move_deg = [-30.0, 400.0]", "doublet[1].move_deg[1]",
     "-360 .. 360"},
    {"MoveBeyondTheEnd", "duration_s = 1.4", "duration_s = 3.6", "move[1].duration_s",
     "the move ends at 6.2 s", "", kMoves},
    {"MovesOverlap", "start_s = 2.6", "start_s = 1.9", "move[1].start_s", "do not overlap", "",
     kMoves},
    {"MoveDuringADoublet", "start_s = 1.2", "start_s = 0.9", "move[0].start_s",
     "must not overlap a doublet", "", kMoves},
    {"MoveWithoutAGoal", "to_deg = [10.0, -5.0]", "", "move[0].to_deg", "missing", "[[move]]",
     kMoves},
    {"WildSetPoint", "to_deg = [10.0, -5.0]", "to_deg = [10.0, -500.0]", "move[0].to_deg[1]",
     "-360 .. 360", "", kMoves},
    {"EventAfterTheEnd", "at_s = 2.5", "at_s = 6.5", "sim_event[2].at_s", "inside the experiment"},
    {"UnknownLine", "line = \"limit-1-high\"", "line = \"limit-3-high\"", "sim_event[0].line",
     "\"emergency-stop\""},
    {"LineWithoutLevel", "level = 0", "", "sim_event[0].level", "missing", "[[sim_event]]"},
    {"LevelWithoutLine", "line = \"limit-1-high\"", "kill = true", "sim_event[0].level",
     "must stand beside line", "level = 0"},
    {"LevelOfTwo", "level = 0", "level = 2", "sim_event[0].level", "must be 0"},
    {"TwoThingsInOneEvent", "kill = true", "kill = true\nfreeze = \"plant\"", "sim_event[2]",
     "exactly one of", "\"control\"\n\n[[sim_event]]"},
    {"NothingInAnEvent", "kill = true", "kill = false", "sim_event[2]", "exactly one of",
     "\"control\"\n\n[[sim_event]]"},
    {"UnknownFreeze", "freeze = \"control\"", "freeze = \"safety\"", "sim_event[1].freeze",
     "one of \"plant\" \"control\""},
    {"EventIsNoRow", "[[doublet]]", "sim_event = 3\n[[doublet]]", "", "not valid TOML",
     "[[sim_event]]"},
};
INSTANTIATE_TEST_SUITE_P(All, BrokenExperiment, ::testing::ValuesIn(kBroken),
                         [](const auto& c) { return c.param.name; });

TEST(ExperimentFile, ThatIsNotThereIsNamed) {
  try {
    LoadExperiment("no-such-file.toml");
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_STREQ(error.what(), "no-such-file.toml: cannot be read: No such file or directory");
  }
}

}  // namespace
}  // namespace flexarm
