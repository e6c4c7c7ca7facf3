// The runs of a folder: heads of logs, labels, and what is changed afterwards.

#include "controller/runlog/run_list.h"

#include <nlohmann/json.hpp>

#include "controller/runlog/run_label.h"
#include "controller/runlog/run_labels_file.h"
#include "tests/controller/runlog/runlog_fixture.h"

namespace flexarm {
namespace {

class RunListTest : public RunLogTest {
 protected:
  std::filesystem::path Run(const std::string& name, const std::string& start_utc,
                            const std::string& result, const RunLabel& label = {}) {
    RunInfo info = MakeInfo();
    info.start_utc = start_utc;
    info.law = "sobel";
    info.payload_kg = 0.1;
    info.label = label;
    RunWriter writer(File(name), info);
    writer.Tick(MakeTick(1));
    writer.Close(result);
    return File(name);
  }
  std::vector<std::string> Names() {
    std::vector<std::string> names;
    for (const ListedRun& run : ListRuns(folder_)) names.push_back(run.file.filename());
    return names;
  }
};

const RunLabel kLabel{.name = "new gauge", .note = "glued \xC3\xA4", .tags = {"bench", "gauge-7"}};

TEST_F(RunListTest, AHeadIsReadFromAClosedRunAndFromOneThatIsBeingWritten) {
  Run("closed.flexarm", "2026-11-20T12:00:00Z",
      R"({"trip": null, "stopped": true, "duration_s": 2.5})", kLabel);
  const RunHead closed = ReadRunHead(File("closed.flexarm"));
  EXPECT_EQ(closed.info.label, kLabel);
  EXPECT_EQ(closed.info.law, "sobel");
  EXPECT_EQ(closed.info.payload_kg, 0.1);
  EXPECT_EQ(closed.end, RunEnd::kStopped);
  EXPECT_EQ(closed.duration_s, 2.5);

  RunInfo info = MakeInfo();
  info.label = kLabel;
  RunWriter writer(File("open.flexarm"), info);
  writer.Tick(MakeTick(1));
  writer.Commit();
  const RunHead open = ReadRunHead(File("open.flexarm"));
  EXPECT_EQ(open.info.label, kLabel);
  EXPECT_EQ(open.info.payload_kg, std::nullopt);
  EXPECT_EQ(open.state, RunState::kWritten);
  EXPECT_EQ(open.end, RunEnd::kOpen);
}

TEST_F(RunListTest, HowARunEndedIsInItsResult) {
  const std::pair<const char*, RunEnd> ends[] = {
      {R"({"trip": null, "stopped": false})", RunEnd::kComplete},
      {R"({"trip": null, "stopped": true})", RunEnd::kStopped},
      {R"({"trip": "sensor-stuck", "recovered": true})", RunEnd::kTripped},
      {R"({"trip": null, "recovered": true})", RunEnd::kCutShort},
      {"", RunEnd::kOpen},
      {"[1, 2]", RunEnd::kOpen},
      {"no JSON", RunEnd::kOpen},
  };
  for (const auto& [result, end] : ends) {
    EXPECT_EQ(ReadRunHead(Run("run.flexarm", "2026-11-20T12:00:00Z", result)).end, end) << result;
    std::filesystem::remove(File());
  }
}

TEST_F(RunListTest, TheNewestComesFirstAndWhatCannotBeReadLastWithItsReason) {
  Run("b.flexarm", "2026-11-20T12:00:00Z", "{}");
  Run("a.flexarm", "2026-11-21T12:00:00Z", "{}");
  Run("c.flexarm", "2026-11-19T12:00:00Z", "{}");
  WriteText(File("0.flexarm"), "not a run");
  std::filesystem::create_directory(File("z.flexarm"));
  WriteText(File("other.txt"), "not listed");
  WriteText(File(".next-1.flexarm"), "not listed");
  EXPECT_EQ(Names(), (std::vector<std::string>{"a.flexarm", "b.flexarm", "c.flexarm", "z.flexarm",
                                               "0.flexarm"}));
  EXPECT_NE(ListRuns(folder_).back().problem.find("not a run log"), std::string::npos);
  EXPECT_EQ(NewestRun(folder_), File("a.flexarm"));
}

TEST_F(RunListTest, AFolderWithoutRunsOrThatIsMissingIsNamed) {
  WriteText(File("0.flexarm"), "not a run");
  EXPECT_NE(MessageOf<InputError>([&] { NewestRun(folder_); }).find("has no run log"),
            std::string::npos);
  EXPECT_NE(MessageOf<InputError>([&] { ListRuns(folder_ / "none"); }).find("--folder"),
            std::string::npos);
}

TEST_F(RunListTest, AChangedLabelStandsBesideTheLogWhichStaysAsItWas) {
  Run("run.flexarm", "2026-11-20T12:00:00Z", "{}", kLabel);
  Run("other.flexarm", "2026-11-19T12:00:00Z", "{}", kLabel);
  const std::string before = Bytes(File());
  ChangeLabel(File(), [](RunLabel* label) { label->tags = {"good"}; });
  ChangeLabel(File(), [](RunLabel* label) { label->note = "as new"; });
  EXPECT_EQ(Bytes(File()), before);
  const std::vector<ListedRun> runs = ListRuns(folder_);
  EXPECT_EQ(runs.at(0).label, (RunLabel{.name = kLabel.name, .note = "as new", .tags = {"good"}}));
  EXPECT_EQ(runs.at(1).label, kLabel);
}

TEST_F(RunListTest, AChangeThatMakesNoLabelChangesNothing) {
  Run("run.flexarm", "2026-11-20T12:00:00Z", "{}");
  for (const char* const tag : {"", "two\nlines", "\xFF", "\xE2\x80\xAEturned"}) {
    const std::string error = MessageOf<InputError>(
        [&] { ChangeLabel(File(), [&](RunLabel* label) { label->tags = {tag}; }); });
    EXPECT_NE(error.find("run.flexarm: a tag "), std::string::npos) << error;
  }
  EXPECT_FALSE(std::filesystem::exists(File("flexarm-labels.json")));
}

TEST_F(RunListTest, AMalformedFileOfLabelsIsNamed) {
  Run("run.flexarm", "2026-11-20T12:00:00Z", "{}");
  for (const char* const text : {"[", "[]", "{}", R"({"flexarm_labels": 2, "runs": {}})",
                                 R"({"flexarm_labels": 1, "runs": {"a": {"tags": 3}}})",
                                 R"({"flexarm_labels": 1, "runs": {"a": {"name": "\u001b["}}})"}) {
    WriteText(File("flexarm-labels.json"), text);
    const std::string error = MessageOf<InputError>([&] { ListRuns(folder_); });
    EXPECT_NE(error.find("flexarm-labels.json"), std::string::npos) << text << '\n' << error;
    EXPECT_NE(error.find("expected the labels of the run logs"), std::string::npos) << error;
  }
}

TEST(RunLabels, TextsOfALogMayBeAnything) {
  EXPECT_EQ(LabelOfText("no JSON"), RunLabel{});
  EXPECT_EQ(LabelOfText(std::string(100'000, '[')), RunLabel{});
  EXPECT_EQ(LabelOfText(R"({"tags": {}})"), RunLabel{});
  EXPECT_EQ(LabelOfText(LabelToJson(kLabel).dump()), kLabel);
}

}  // namespace
}  // namespace flexarm
