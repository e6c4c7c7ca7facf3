#include "tools/sweep/sweep.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>

#include "controller/runlog/errors.h"
#include "tests/support/message_of.h"
#include "tools/sweep/plant_variant.h"
#include "tools/sweep/sweep_summary.h"

namespace flexarm {
namespace {

using Texts = std::vector<std::string>;

constexpr const char* kHilRig = FLEXARM_SOURCE_DIR "/config/hil.toml";

SweepAxis Axis(const std::string& text) { return ParseAxis(AxisTarget::kConfig, text); }

SweepPlan Plan(std::vector<SweepAxis> axes) {
  return {.config = LoadConfig(kHilRig),
          .experiment = LoadExperiment(FLEXARM_SOURCE_DIR "/config/experiments/square-30deg.toml"),
          .grid = SweepGrid(std::move(axes))};
}

// An invented result that identifies its point.
SweepRow Made(std::size_t point) {
  SweepRow row{.point = point, .completed = true, .trip = {}, .refused = {}, .ticks = 301};
  row.measure.fill(static_cast<double>(point) + 0.1);
  return row;
}

class SweepFiles : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path File(const std::string& name) const { return folder_ / name; }

  std::filesystem::path folder_;
};

TEST(SweepValues, AreListsOrRangesWithBothEnds) {
  EXPECT_EQ(ParseValues("3, 2.5,x"), (Texts{"3", "2.5", "x"}));
  EXPECT_EQ(ParseValues("[30, 6],[15, 3]"), (Texts{"[30, 6]", "[15, 3]"}));
  EXPECT_EQ(ParseValues("\"a,b\",c"), (Texts{"\"a,b\"", "c"}));
  EXPECT_EQ(ParseValues("0:0.1:0.3"), (Texts{"0", "0.1", "0.2", "0.3"}));
  EXPECT_EQ(ParseValues("1:-0.5:0.2"), (Texts{"1", "0.5"}));
  EXPECT_EQ(ParseValues("-1..1"), (Texts{"-1", "0", "1"}));
}

TEST(SweepValues, InvalidOnesAreRefused) {
  for (const char* text : {"", "1,,2", "1,2,1", "0:1:-1", "0:0:1", "3..1", "1:nan:2", "0:1e-9:1"}) {
    EXPECT_THROW(ParseValues(text), InputError) << text;
  }
  for (const char* text : {"key", "=1", "key="}) EXPECT_THROW(Axis(text), InputError) << text;
  EXPECT_THROW(SweepGrid({Axis("a.b=1"), Axis("a.b=2")}), InputError);
}

TEST(SweepGrid, HasEveryCombinationOnceAndTheLastAxisVariesFastest) {
  const SweepGrid grid({Axis("a.a=1,2"), Axis("b.b=x,y,z"), Axis("c.c=5,6")});
  ASSERT_EQ(grid.size(), 12U);
  std::set<Texts> seen;
  for (std::size_t point = 0; point < grid.size(); ++point) seen.insert(grid.Values(point));
  EXPECT_EQ(seen.size(), 12U);
  EXPECT_EQ(grid.Values(0), (Texts{"1", "x", "5"}));
  EXPECT_EQ(grid.Values(1), (Texts{"1", "x", "6"}));
  EXPECT_EQ(grid.Values(11), (Texts{"2", "z", "6"}));
}

TEST(SweepShards, AreDisjointAndCompleteForEveryNumberOfThem) {
  for (std::size_t count = 1; count <= 40; ++count) {
    for (std::size_t point = 0; point < 100; ++point) {
      std::size_t owners = 0;
      for (std::size_t number = 1; number <= count; ++number) {
        if (Shard{number, count}.Has(point)) ++owners;
      }
      ASSERT_EQ(owners, 1U) << "point " << point << " of " << count << " shards";
    }
  }
}

TEST(SweepShards, AreCountedFromOne) {
  EXPECT_EQ(ParseShard("4/4").number, 4U);
  for (const char* text : {"0/4", "5/4", "1", "1/0", "/", "a/b", "-1/4", "1/4x"}) {
    EXPECT_THROW(ParseShard(text), InputError) << text;
  }
}

TEST(SweepPlan, PlantAxesLeaveTheControllersConfigAlone) {
  const SweepPlan plan = Plan({Axis("controller.alpha=2.0"),
                               ParseAxis(AxisTarget::kPlant, "joint1.coulomb_friction_nm=0.5"),
                               {AxisTarget::kVariant, "", {"soft-joints"}},
                               {AxisTarget::kPayload, "", {"0.2"}},
                               {AxisTarget::kSeed, "", {"7"}}});
  const SimulationRequest request = RequestAt(plan, 0);
  EXPECT_EQ(NumberAt(request.config, "controller.alpha"), 2.0);
  EXPECT_EQ(NumberAt(request.config, "joint1.coulomb_friction_nm"), 0.16);
  EXPECT_EQ(NumberAt(request.config, "joint1.stiffness_nm_per_rad"), 761.59);
  ASSERT_TRUE(request.plant.has_value());
  EXPECT_EQ(NumberAt(*request.plant, "joint1.coulomb_friction_nm"), 0.5);
  EXPECT_NEAR(*NumberAt(*request.plant, "joint1.stiffness_nm_per_rad"), 0.7 * 761.59, 1e-9);
  EXPECT_EQ(request.plant->sim.seed, 7U);
  EXPECT_EQ(request.payload_kg, 0.2);
}

TEST(SweepPlan, EveryVariantIsAnotherPlantAndChangesTheRun) {
  const SweepRow nominal = RunPoint(Plan({{AxisTarget::kVariant, "", {"nominal"}}}), 0);
  for (const PlantVariant& variant : PlantVariants()) {
    const SweepRow row = RunPoint(Plan({{AxisTarget::kVariant, "", {variant.name}}}), 0);
    EXPECT_EQ(row.ticks, nominal.ticks) << variant.name;
    EXPECT_EQ(row.trip, "") << variant.name;
    EXPECT_EQ(SameOutcome(row, nominal), std::string(variant.name) == "nominal") << variant.name;
  }
}

TEST(SweepPlan, InvalidValuesAreRefusedBeforeAnyRun) {
  EXPECT_THROW(CheckPlan(Plan({Axis("controller.alfa=1")})), ConfigError);
  EXPECT_THROW(CheckPlan(Plan({Axis("controller.alpha=1.0,two")})), ConfigError);
  EXPECT_THROW(CheckPlan(Plan({ParseAxis(AxisTarget::kPlant, "controller.alpha=1.0")})),
               InputError);
  EXPECT_THROW(CheckPlan(Plan({{AxisTarget::kVariant, "", {"wooden"}}})), InputError);
  EXPECT_THROW(CheckPlan(Plan({{AxisTarget::kPayload, "", {"-1"}}})), InputError);
  SweepPlan deadly = Plan({{AxisTarget::kSeed, "", {"1"}}});
  deadly.experiment.sim_event.push_back(
      {.at_s = 1.0, .line = {}, .level = 0, .freeze = FreezeTarget::kNone, .kill = true});
  EXPECT_THROW(CheckPlan(deadly), InputError);
}

// The oracle is the code of flexarm simulate: the same config from its overrides, one run.
TEST_F(SweepFiles, HoldTheResultsOfSingleRunsForAnyNumberOfJobs) {
  const SweepPlan plan =
      Plan({Axis("controller.alpha=2.0,3.0"), {AxisTarget::kSeed, "", {"1", "2"}}});
  SweepFile one = SweepFile::Resume(File("one"), IdentityOf(plan));
  SweepFile four = SweepFile::Resume(File("four"), IdentityOf(plan));
  RunSweep(plan, PointsToRun(&one, {}), &one, 1);
  RunSweep(plan, PointsToRun(&four, {}), &four, 4);
  const auto rows = one.Rows(), rows4 = four.Rows();
  ASSERT_EQ(rows.size(), 4U);
  ASSERT_EQ(rows4.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_TRUE(SameOutcome(rows[i], rows4[i])) << i;
  const SimulationRequest single{
      .config = LoadConfig(kHilRig, {"controller.alpha=3.0", "sim.seed=1"}),
      .experiment = plan.experiment,
      .plant = {},
      .payload_kg = {},
      .log = {}};
  EXPECT_TRUE(SameOutcome(rows[2], RowOf(2, single, Simulate(single))));
  EXPECT_TRUE(PointsToRun(&one, {}).empty());
}

TEST_F(SweepFiles, OfAnotherSweepAreRefusedAndTheDifferenceIsNamed) {
  const SweepIdentity held = IdentityOf(Plan({Axis("controller.alpha=2.0,3.0")}));
  SweepFile::Resume(File("a"), held);
  EXPECT_NO_THROW(SweepFile::Resume(File("a"), held));
  const auto refusal = [this](const SweepIdentity& other) {
    return MessageOf<InputError>([&] { SweepFile::Resume(File("a"), other); });
  };
  SweepIdentity other = held;
  other.axes[0].values = {"2.0"};
  EXPECT_NE(refusal(other).find("sweeps controller.alpha = 2.0,3.0; not"), std::string::npos);
  other = held;
  other.config_text += "more = 1\n";
  EXPECT_NE(refusal(other).find("another config: \"(end)\" there, \"more = 1\" here"),
            std::string::npos);
  other = held;
  other.experiment_text += "#";
  EXPECT_NE(refusal(other).find("another experiment"), std::string::npos);
  other = held;
  other.build = "yesterday's";
  EXPECT_NE(refusal(other).find("another build"), std::string::npos);
}

TEST_F(SweepFiles, MergeJoinsShardsAndNamesMissingPoints) {
  const SweepIdentity identity = IdentityOf(Plan({Axis("controller.alpha=1:1:7")}));
  for (std::size_t number = 1; number <= 3; ++number) {
    SweepFile part = SweepFile::Resume(File(std::to_string(number)), identity);
    for (const std::size_t point : PointsToRun(&part, {number, 3})) {
      if (point != 4) part.Add(Made(point));
    }
  }
  EXPECT_EQ(MergeSweeps({File("1"), File("2"), File("3")}, File("all")),
            (std::vector<std::size_t>{4}));
  SweepFile all = SweepFile::Open(File("all"));
  ASSERT_EQ(all.Rows().size(), 6U);
  for (const SweepRow& row : all.Rows()) EXPECT_TRUE(SameOutcome(row, Made(row.point)));
  EXPECT_THROW(MergeSweeps({File("1")}, File("all")), InputError) << "overwrites results";
}

TEST_F(SweepFiles, MergeRefusesPartsThatContradictOrAreOfAnotherSweep) {
  const SweepIdentity identity = IdentityOf(Plan({Axis("controller.alpha=1,2")}));
  SweepIdentity other = identity;
  other.axes[0].values = {"1", "5"};
  SweepFile::Resume(File("a"), identity).Add(Made(0));
  SweepFile::Resume(File("b"), other).Add(Made(0));
  SweepRow wrong = Made(0);
  wrong.measure[3] += 1e-9;
  SweepFile::Resume(File("c"), identity).Add(wrong);
  SweepFile::Resume(File("d"), identity).Add(Made(0));
  EXPECT_THROW(MergeSweeps({File("a"), File("b")}, File("x")), InputError);
  EXPECT_THROW(MergeSweeps({File("a"), File("c")}, File("x")), InputError);
  EXPECT_FALSE(std::filesystem::exists(File("x")));
  EXPECT_EQ(MergeSweeps({File("a"), File("d")}, File("y")), (std::vector<std::size_t>{1}));
}

TEST_F(SweepFiles, SummaryTakesMediansOfTheRunsThatCompleted) {
  const SweepIdentity identity =
      IdentityOf(Plan({Axis("controller.alpha=1,2"), {AxisTarget::kSeed, "", {"1", "2", "3"}}}));
  SweepFile file = SweepFile::Resume(File("a"), identity);
  for (std::size_t point = 0; point < 5; ++point) file.Add(Made(point));
  SweepRow tripped = Made(5);
  tripped.completed = false;
  tripped.trip = "limit";
  file.Add(tripped);
  const SweepSummary summary = Summarise(&file, "");
  ASSERT_EQ(summary.groups.size(), 2U);
  EXPECT_EQ(summary.groups[0].median[0], 1.1);           // of 0.1, 1.1, 2.1
  EXPECT_NEAR(summary.groups[1].median[0], 3.6, 1e-12);  // of 3.1, 4.1
  EXPECT_EQ(summary.groups[1].completed, 2U);
  EXPECT_EQ(summary.groups[1].trips, (Texts{"limit"}));
  EXPECT_THROW(Summarise(&file, "controller.vartheta"), InputError);
}

}  // namespace
}  // namespace flexarm
