#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "config/config.h"
#include "tests/config/broken_text.h"
#include "tests/config/config_testing.h"
#include "tests/support/message_of.h"

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

[[sim_event]]
at_s = 3.5
payload_kg = 0.25
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

TEST(ExperimentFile, EveryKeyOfAMoveIsRead) {
  const Experiment e = ParseExperiment(kMoves, "e.toml");
  ASSERT_EQ(e.move.size(), 2U);
  EXPECT_EQ(e.move[0].start_s, 1.2);
  EXPECT_EQ(e.move[0].duration_s, 0.8);
  EXPECT_EQ(e.move[0].to_deg, (std::array{10.0, -5.0}));
}

TEST(ExperimentFile, LawsAndPayloadsAreReadAndMayBeLeftOut) {
  const Experiment any = ParseExperiment(kMoves, "e.toml");
  EXPECT_TRUE(any.laws.empty());
  EXPECT_FALSE(any.payload_kg);
  const Experiment e =
      ParseExperiment("laws = [\"gain-scheduled\", \"receding-horizon\"]\npayload_kg = [0, 0.5]\n" +
                          std::string(kMoves),
                      "e.toml");
  EXPECT_EQ(e.laws,
            (std::vector{ControllerKind::kGainScheduled, ControllerKind::kRecedingHorizon}));
  EXPECT_EQ(e.payload_kg, (std::array{0.0, 0.5}));
}

TEST(ExperimentFile, WrongLawsAndPayloadsAreNamed) {
  const auto refusal = [](const std::string& line) {
    return MessageOf<ConfigError>([&] { ParseExperiment(line + "\n" + kMoves, "e.toml"); });
  };
  EXPECT_THAT(refusal("laws = [\"sobell\"]"),
              AllOf(HasSubstr("e.toml:1: laws"), HasSubstr("did you mean \"sobel\"?")));
  EXPECT_THAT(refusal("laws = [\"mpc\"]"), HasSubstr("unknown law \"mpc\"; the laws are: sobel "));
  EXPECT_THAT(refusal("laws = []"), HasSubstr("must be an array of strings"));
  EXPECT_THAT(refusal("laws = \"sobel\""), HasSubstr("must be an array of strings"));
  EXPECT_THAT(refusal("laws = [1]"), HasSubstr("must be an array of strings"));
  EXPECT_THAT(refusal("payload_kg = 0.5"), HasSubstr("e.toml:1: payload_kg"));
  EXPECT_THAT(refusal("payload_kg = [0.5]"), HasSubstr("e.toml:1: payload_kg"));
  EXPECT_THAT(refusal("payload_kg = [0.5, 0.1]"),
              HasSubstr("the least payload, then the greatest"));
  EXPECT_THAT(refusal("payload_kg = [-0.1, 0.1]"), HasSubstr("payload_kg[0] = -0.1"));
  EXPECT_THAT(refusal("payload_kg = [0, inf]"), HasSubstr("payload_kg"));
  EXPECT_THAT(refusal("payload_kgs = [0, 1]"), HasSubstr("did you mean \"payload_kg\"?"));
}

TEST(ExperimentFile, AMoveMayBeTheShortestForTheLoadOfTheMoveBefore) {
  const Experiment e = ParseExperiment(
      Replaced(kMoves, "duration_s = 1.4", "duration = \"shortest\"\nsame_load = true") +
          "[[load_change]]\nat_s = 1.5\n[[load_change]]\nat_s = 2.5\n",
      "e.toml");
  EXPECT_FALSE(e.move[0].shortest || e.move[0].same_load);
  EXPECT_TRUE(e.move[1].shortest && e.move[1].same_load);
  EXPECT_FALSE(e.move[1].duration_s);
  ASSERT_EQ(e.load_change.size(), 2U);
  EXPECT_EQ(e.load_change[1].at_s, 2.5);
}

TEST(ExperimentFile, WrongDurationsAndLoadChangesAreNamed) {
  const auto refusal = [](const std::string& line, const std::string& rows = "") {
    return MessageOf<ConfigError>(
        [&] { ParseExperiment(Replaced(kMoves, "duration_s = 1.4", line) + rows, "e.toml"); });
  };
  EXPECT_THAT(refusal("duration = \"longest\""),
              AllOf(HasSubstr("e.toml:17: move[1].duration"), HasSubstr("shortest")));
  EXPECT_THAT(refusal("duration = 1.4"), HasSubstr("move[1].duration"));
  EXPECT_THAT(refusal("duration = \"shortest\"\nduration_s = 1.4"),
              HasSubstr("must not be given beside duration"));
  EXPECT_THAT(refusal("duration_s = 1.4", "[[load_change]]\nat_s = 6.5\n"),
              AllOf(HasSubstr("load_change[0].at_s = 6.5"), HasSubstr("inside the experiment")));
  EXPECT_THAT(refusal("duration_s = 1.4", "[[load_change]]\nat_s = 3\n[[load_change]]\nat_s = 2\n"),
              AllOf(HasSubstr("load_change[1].at_s = 2"), HasSubstr("in order of time")));
}

// The law decides whether it accepts a retarget.
TEST(ExperimentFile, AMoveMayBeginDuringTheMoveBefore) {
  const Experiment e =
      ParseExperiment(Replaced(kMoves, "start_s = 2.6", "start_s = 1.5"), "e.toml");
  EXPECT_EQ(e.move[1].start_s, 1.5);
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

constexpr const char* kKinds = R"(name = "kinds"
duration_s = 60.0

[[move]]
start_s = 0.0
to_tip_m = [1.2, -0.4]
elbow = "left"
profile = "septic"

[[chirp]]
start_s = 10.0
duration_s = 8.0
from_hz = 0.5
to_hz = 4.0
amplitude_deg = [1.0, 2.0]

[[prbs]]
start_s = 20.0
hold_s = 0.1
bits = 5
seed = 3
torque_nm = [2.0, 0.3]

[csv]
start_s = 40.0
file = "swing.csv"

[[attached]]
file = "swing.csv"
text = '''
# seconds, degrees
time_s,th1_deg,th2_deg
0,0,0
0.5, 9, -18
1.5,18,-36
'''
)";

TEST(ExperimentFile, EveryKindOfRowIsRead) {
  const Experiment e = ParseExperiment(kKinds, "e.toml");
  ASSERT_EQ(e.move.size(), 1U);
  EXPECT_FALSE(e.move[0].duration_s.has_value());
  EXPECT_EQ(e.move[0].to_tip_m, (std::array{1.2, -0.4}));
  EXPECT_EQ(e.move[0].elbow, ElbowSide::kLeft);
  EXPECT_EQ(e.move[0].profile, MoveProfile::kSeptic);
  ASSERT_EQ(e.chirp.size(), 1U);
  EXPECT_EQ(e.chirp[0].start_s, 10.0);
  EXPECT_EQ(e.chirp[0].duration_s, 8.0);
  EXPECT_EQ(e.chirp[0].from_hz, 0.5);
  EXPECT_EQ(e.chirp[0].to_hz, 4.0);
  EXPECT_EQ(e.chirp[0].amplitude_deg, (std::array{1.0, 2.0}));
  ASSERT_EQ(e.prbs.size(), 1U);
  EXPECT_EQ(e.prbs[0].start_s, 20.0);
  EXPECT_EQ(e.prbs[0].hold_s, 0.1);
  EXPECT_EQ(e.prbs[0].bits, 5);
  EXPECT_EQ(e.prbs[0].seed, 3);
  EXPECT_EQ(e.prbs[0].torque_nm, (std::array{2.0, 0.3}));
  ASSERT_TRUE(e.csv.has_value());
  EXPECT_EQ(e.csv->start_s, 40.0);
  ASSERT_EQ(e.csv->point.size(), 3U);
  EXPECT_EQ(e.csv->point[1].time_s, 0.5);
  EXPECT_NEAR(e.csv->point[2].angle_rad[0], 0.314159265, 1e-9) << "18 deg";
  EXPECT_NEAR(e.csv->point[1].angle_rad[1], -0.314159265, 1e-9);
}

TEST(ExperimentFile, AComputedDurationIsReadBack) {
  const std::string planned =
      std::string(kKinds) + "\n[[planned_move]]\nrow = 0\nduration_s = 1.3\n";
  EXPECT_EQ(ParseExperiment(planned, "e.toml").move[0].duration_s, 1.3);
}

// The text of the experiment contains the CSV file: it can be parsed without the file.
TEST(ExperimentFile, TheCsvFileIsAttachedToTheText) {
  const std::filesystem::path file = FLEXARM_SOURCE_DIR "/config/experiments/trajectory.toml";
  const Experiment loaded = LoadExperiment(file);
  const Experiment again = ParseExperiment(loaded.text, "elsewhere.toml");
  ASSERT_TRUE(again.csv.has_value());
  EXPECT_EQ(again.csv->point.size(), loaded.csv->point.size());
  EXPECT_EQ(again.csv->point.back().angle_rad, loaded.csv->point.back().angle_rad);
  EXPECT_EQ(again.text, loaded.text);
}

std::string RefusedCsv(const std::string& from, const std::string& to) {
  return MessageOf<std::exception>([&] { ParseExperiment(Replaced(kKinds, from, to), "e.toml"); });
}

TEST(ExperimentFile, AFaultyTrajectoryIsNamedByFileAndLine) {
  EXPECT_THAT(RefusedCsv("0.5, 9, -18", "0.5, 9, x"),
              AllOf(HasSubstr("e.toml:26: csv.file"),
                    HasSubstr("swing.csv:4: th2_deg: found \"x\", expected a number")));
  EXPECT_THAT(RefusedCsv("1.5,18,-36", "0.4,18,-36"),
              AllOf(HasSubstr("swing.csv:5: time_s"), HasSubstr("later")));
  EXPECT_THAT(RefusedCsv("0,0,0", "0.1,0,0"), HasSubstr("swing.csv:3: time_s: found \"0.1\""));
  EXPECT_THAT(RefusedCsv("time_s,th1_deg", "time_s,th1_grad"), HasSubstr("swing.csv:2"));
  EXPECT_THAT(RefusedCsv("0.5, 9, -18\n1.5,18,-36\n", ""), HasSubstr("at least two rows"));
}

TEST(ExperimentFile, EveryKeyIsRead) {
  const Experiment e = ParseExperiment(kExperiment, "e.toml");
  EXPECT_EQ(e.name, "switch");
  EXPECT_EQ(e.text, kExperiment);
  EXPECT_EQ(e.duration_s, 6.0);
  ASSERT_EQ(e.doublet.size(), 2U);
  EXPECT_EQ(e.doublet[1].shape, DoubletShape::kSine);
  EXPECT_EQ(e.doublet[1].duration_s, 1.5);
  EXPECT_EQ(e.doublet[1].move_deg, (std::array{-30.0, 0.0}));
  ASSERT_EQ(e.sim_event.size(), 4U);
  EXPECT_EQ(e.sim_event[0].line, Line::kLimit1High);
  EXPECT_EQ(e.sim_event[0].level, 0);
  EXPECT_EQ(e.sim_event[1].freeze, FreezeTarget::kControl);
  EXPECT_FALSE(e.sim_event[1].line.has_value());
  EXPECT_FALSE(e.sim_event[1].kill);
  EXPECT_TRUE(e.sim_event[2].kill);
  EXPECT_FALSE(e.sim_event[2].payload_kg.has_value());
  EXPECT_EQ(e.sim_event[3].payload_kg, 0.25);
}

TEST(ExperimentFile, MayHaveNoRows) {
  EXPECT_NO_THROW(ParseExperiment("name = \"hold\"\nduration_s = 2\n", "e.toml"));
}

// The log of a run holds the duration that was chosen.
TEST(ExperimentFile, WithoutDurationItEndsAfterItsRows) {
  std::string text = kMoves;
  text.erase(text.find("duration_s = 6.0"), 16);
  const Experiment open = ParseExperiment(text, "e.toml");
  EXPECT_TRUE(open.ends_after_rows);
  EXPECT_EQ(open.duration_s, kLongestRun_s);
  EXPECT_EQ(ParseExperiment(text + "[planned]\nduration_s = 5.0\n", "e.toml").duration_s, 5.0);
  EXPECT_FALSE(ParseExperiment(kMoves, "e.toml").ends_after_rows);
  EXPECT_THAT(MessageOf<ConfigError>([] {
                ParseExperiment(std::string(kMoves) + "[planned]\nduration_s = 5.0\n", "e.toml");
              }),
              HasSubstr("must not be given beside duration_s: a run has one length"));
  EXPECT_THAT(MessageOf<ConfigError>([] { ParseExperiment("name = \"hold\"\n", "e.toml"); }),
              HasSubstr("duration_s: must be given where no row says when the run is over"));
}

class BrokenExperiment : public ::testing::TestWithParam<BrokenText> {};

TEST_P(BrokenExperiment, IsReportedOnceWithLineKeyAndRule) {
  const BrokenText& c = GetParam();
  const std::string text = c.Edit(c.text.empty() ? kExperiment : c.text);
  ExpectReportedOnce(c, text, "e.toml", ProblemsFrom([&] { ParseExperiment(text, "e.toml"); }));
}

const BrokenText kBroken[] = {
    {"NoName", "name = \"switch\"", "", "name", "missing", "no line"},
    {"EmptyName", "name = \"switch\"", "name = \"\"", "name", "1 to 64 printable"},
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
    {"MovesOutOfOrder", "start_s = 2.6", "start_s = 1.2", "move[1].start_s",
     "later than the move above it, at 1.2 s", "to_deg = [10.0, -5.0]\n\n[[move]]\nstart_s = 1.2",
     kMoves},
    {"MoveDuringADoublet", "start_s = 1.2", "start_s = 0.9", "move[0].start_s",
     "must not overlap a doublet", "", kMoves},
    {"MoveWithoutAGoal", "to_deg = [10.0, -5.0]", "", "move[0].to_deg", "missing", "[[move]]",
     kMoves},
    {"WildSetPoint", "to_deg = [10.0, -5.0]", "to_deg = [10.0, -500.0]", "move[0].to_deg[1]",
     "-360 .. 360", "", kMoves},
    {"TipAndAngles", "elbow = \"left\"", "to_deg = [1.0, 2.0]", "move[0].to_deg", "one goal", "",
     kKinds},
    {"ElbowOfAngles", "to_tip_m = [1.2, -0.4]", "to_deg = [1.0, 2.0]", "move[0].elbow",
     "with to_tip_m", "elbow", kKinds},
    {"UnknownProfile", "profile = \"septic\"", "profile = \"linear\"", "move[0].profile",
     "one of \"quintic\" \"septic\"", "", kKinds},
    {"ChirpOfNoFrequency", "to_hz = 4.0", "to_hz = 0.0", "chirp[0].to_hz", "above 0", "", kKinds},
    {"ChirpDuringThePrbs", "start_s = 10.0", "start_s = 13.0", "prbs[0].start_s",
     "must not overlap a chirp", "start_s = 20.0", kKinds},
    {"PrbsOfOneBit", "bits = 5", "bits = 1", "prbs[0].bits", "2 .. 12", "", kKinds},
    {"PrbsWithoutASeed", "seed = 3", "seed = 32", "prbs[0].seed", "1 .. 31", "", kKinds},
    {"PrbsBeyondTheEnd", "start_s = 20.0", "start_s = 50.0", "prbs[0].bits", "must end inside",
     "bits = 5", kKinds},
    {"CsvNotAttached", "file = \"swing.csv\"\n\n", "file = \"other.csv\"\n\n", "csv.file",
     "must be attached", "file = \"other.csv\"", kKinds},
    {"CsvBeyondTheEnd", "start_s = 40.0", "start_s = 59.0", "csv.file", "must end inside",
     "file = \"swing.csv\"", kKinds},
    {"PlannedMoveOfNoMove", "[csv]", "[[planned_move]]\nrow = 1\nduration_s = 1\n[csv]",
     "planned_move[0].row", "without duration_s", "row = 1", kKinds},
    {"EventAfterTheEnd", "at_s = 2.5", "at_s = 6.5", "sim_event[2].at_s", "inside the experiment"},
    {"UnknownLine", "line = \"limit-1-high\"", "line = \"limit-3-high\"", "sim_event[0].line",
     "\"emergency-stop\""},
    {"LineWithoutLevel", "level = 0", "", "sim_event[0].level", "missing", "[[sim_event]]"},
    {"LevelWithoutLine", "line = \"limit-1-high\"", "kill = true", "sim_event[0].level",
     "must be given with line", "level = 0"},
    {"LevelOfTwo", "level = 0", "level = 2", "sim_event[0].level", "must be 0"},
    {"TwoThingsInOneEvent", "kill = true", "kill = true\nfreeze = \"plant\"", "sim_event[2]",
     "exactly one of", "\"control\"\n\n[[sim_event]]"},
    {"NothingInAnEvent", "kill = true", "kill = false", "sim_event[2]", "exactly one of",
     "\"control\"\n\n[[sim_event]]"},
    {"UnknownFreeze", "freeze = \"control\"", "freeze = \"safety\"", "sim_event[1].freeze",
     "one of \"plant\" \"control\""},
    {"PayloadBelowNothing", "payload_kg = 0.25", "payload_kg = -0.1", "sim_event[3].payload_kg",
     "0 .. 100: the payload of the plant"},
    {"PayloadOfNoArm", "payload_kg = 0.25", "payload_kg = 101.0", "sim_event[3].payload_kg",
     "0 .. 100"},
    {"PayloadThatIsNoNumber", "payload_kg = 0.25", "payload_kg = nan", "sim_event[3].payload_kg",
     "must be a finite number"},
    {"PayloadAndAFreeze", "payload_kg = 0.25", "payload_kg = 0.25\nfreeze = \"plant\"",
     "sim_event[3]", "exactly one of", "kill = true\n\n[[sim_event]]"},
    {"EventIsNoRow", "[[doublet]]", "sim_event = 3\n[[doublet]]", "", "not valid TOML",
     "[[sim_event]]"},
};
INSTANTIATE_TEST_SUITE_P(All, BrokenExperiment, ::testing::ValuesIn(kBroken), NameOfCase);

TEST(ExperimentFile, AMissingFileIsNamed) {
  EXPECT_EQ(MessageOf<ConfigError>([] { LoadExperiment("no-such-file.toml"); }),
            "no-such-file.toml: cannot be read: No such file or directory; expected a TOML file");
}

}  // namespace
}  // namespace flexarm
