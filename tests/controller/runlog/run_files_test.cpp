// The files of the daemon's runs: reserved before a run, taken by it, removed unused; a disk that
// refuses is told and tried again.

#include "controller/runlog/run_files.h"

#include <functional>
#include <thread>

#include "controller/runlog/retention.h"
#include "controller/runlog/run_file_lock.h"
#include "tests/controller/runlog/runlog_fixture.h"

namespace flexarm {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

class RunFilesTest : public RunLogTest {
 protected:
  RunFiles& Make(const LogConfig& config = {.reserve_mb = 1.0, .keep_free_mb = 0.0}) {
    files_ = std::make_unique<RunFiles>(folder_ / "runs", config, &finisher_,
                                        [this](bool is_error, const std::string& text) {
                                          (is_error ? errors_ : notes_).push_back(text);
                                        });
    return *files_;
  }
  std::vector<std::filesystem::path> Found() const {
    std::vector<std::filesystem::path> found;
    std::error_code missing;
    for (const auto& entry : std::filesystem::directory_iterator(folder_ / "runs", missing)) {
      found.push_back(entry.path());
    }
    return found;
  }
  static RunInfo InfoOf(const std::string& experiment) {
    RunInfo info = MakeInfo();
    info.experiment_name = experiment;
    return info;
  }

  std::vector<std::string> errors_, notes_;
  RunFinisher finisher_{[this](bool is_error, const std::string& text) {
    (is_error ? errors_ : notes_).push_back(text);
  }};
  std::unique_ptr<RunFiles> files_;
};

TEST_F(RunFilesTest, AFileIsReservedWhenItIsWantedAndRemovedWhenItIsNot) {
  RunFiles& files = Make();
  files.Follow(0);
  EXPECT_TRUE(Found().empty());
  EXPECT_FALSE(files.status().ready);
  files.Want();
  EXPECT_FALSE(files.status().answered) << "it has not been tried yet";
  files.Follow(1);
  EXPECT_TRUE(files.status().ready);
  ASSERT_EQ(Found().size(), 1U);
  EXPECT_TRUE(RunFileIsLocked(Found().front())) << "recovery must leave it alone";
  files.Release();
  EXPECT_FALSE(files.status().ready) << "at once: the next arm needs a file of its own";
  files.Follow(2);
  EXPECT_TRUE(Found().empty());
}

TEST_F(RunFilesTest, AFileOfTheWantBeforeServesOnlyOnceItWasLookedAt) {
  RunFiles& files = Make();
  files.Want();
  files.Follow(0);
  files.Release();
  files.Want();  // before the recorder saw the release
  EXPECT_FALSE(files.status().ready);
  files.Follow(1);
  EXPECT_TRUE(files.status().ready);
  EXPECT_EQ(Found().size(), 1U);
}

TEST_F(RunFilesTest, ARunTakesTheReservedFileAndTheNextIsReserved) {
  RunFiles& files = Make();
  files.Want();
  files.Follow(0);
  std::unique_ptr<RunSink> run = files.Open(InfoOf("sine"));
  EXPECT_NE(run->Name().find("-sine.flexarm"), std::string::npos);
  ASSERT_EQ(Found().size(), 1U);
  EXPECT_EQ(Found().front(), run->Name());
  files.Follow(1);
  EXPECT_EQ(Found().size(), 2U);
  EXPECT_TRUE(files.status().ready);
  EXPECT_EQ(files.status().file, run->Name());
  run->Tick(MakeTick(1));
  run->Commit();
  run->Close("{}");
  run.reset();
  files.Release();
  files.Follow(2);
  finisher_.Stop();
  EXPECT_EQ(finisher_.unfinished(), 0);
  ASSERT_EQ(Found().size(), 1U);
  EXPECT_EQ(RunReader(Found().front()).ReadAll().tick.size(), 1U);
  EXPECT_EQ(files.status().file, "");
  EXPECT_TRUE(errors_.empty());
}

// As of a trip while Idle.
TEST_F(RunFilesTest, ARunWithoutAReservedFileMakesOne) {
  RunFiles& files = Make();
  files.Open(InfoOf("trip"))->Close("{}");
  finisher_.Stop();
  ASSERT_EQ(Found().size(), 1U);
  EXPECT_NE(Found().front().string().find("-trip.flexarm"), std::string::npos);
}

TEST_F(RunFilesTest, ADiskThatRefusesIsToldOnceAndTriedEachSecond) {
  WriteText(folder_ / "runs", "a file where the folder should be");
  RunFiles& files = Make();
  files.Want();
  for (std::int64_t now_ns = 0; now_ns <= 3 * kSecond; now_ns += kSecond / 20) {
    files.Follow(now_ns);
  }
  EXPECT_TRUE(files.status().answered);
  EXPECT_FALSE(files.status().ready);
  EXPECT_NE(files.status().error.find("Not a directory"), std::string::npos);
  ASSERT_EQ(errors_.size(), 1U);
  std::filesystem::remove(folder_ / "runs");
  files.Follow(3 * kSecond + kSecond / 20);
  EXPECT_FALSE(files.status().ready) << "not before its second";
  files.Follow(5 * kSecond);
  EXPECT_TRUE(files.status().ready);
  EXPECT_EQ(files.status().error, "");
}

TEST_F(RunFilesTest, ANewRequestIsTriedAtOnce) {
  WriteText(folder_ / "runs", "a file where the folder should be");
  RunFiles& files = Make();
  files.Want();
  files.Follow(0);
  EXPECT_FALSE(files.status().ready);
  std::filesystem::remove(folder_ / "runs");
  files.Want();
  files.Follow(kSecond / 20);
  EXPECT_TRUE(files.status().ready);
}

TEST_F(RunFilesTest, TooLittleSpaceBesideTheRunIsNoFile) {
  RunFiles& files = Make({.reserve_mb = 1.0, .keep_free_mb = 1e9});
  files.Want();
  files.Follow(0);
  EXPECT_FALSE(files.status().ready);
  EXPECT_NE(files.status().error.find("log.keep_free_mb"), std::string::npos);
  EXPECT_TRUE(Found().empty());
}

TEST_F(RunFilesTest, AReservedFileThatWasRemovedIsReplaced) {
  RunFiles& files = Make();
  files.Want();
  files.Follow(0);
  std::filesystem::remove(Found().front());
  files.Follow(2 * kSecond);
  EXPECT_TRUE(files.status().ready);
  EXPECT_EQ(Found().size(), 1U);
  std::filesystem::remove_all(folder_ / "runs");
  const std::unique_ptr<RunSink> run = files.Open(InfoOf("sine"));  // removed a moment ago
  EXPECT_TRUE(std::filesystem::exists(run->Name()));
  EXPECT_EQ(errors_.size(), 1U);
}

class RetentionTest : public RunLogTest {
 protected:
  // A closed run of an age, in days.
  std::filesystem::path Run(const std::string& name, double age_days,
                            const std::string& result = "{}") {
    const std::filesystem::path file = File(name);
    RunWriter(file, MakeInfo()).Close(result);
    SetAge(file, age_days);
    return file;
  }
  static void SetAge(const std::filesystem::path& file, double age_days) {
    const auto age = std::chrono::duration_cast<std::filesystem::file_time_type::duration>(
        std::chrono::duration<double>(age_days * 86400.0));
    std::filesystem::last_write_time(file, std::filesystem::file_time_type::clock::now() - age);
  }
  void Remove(const LogConfig& config) {
    RemoveOldRuns(folder_, config,
                  [this](bool, const std::string& text) { lines_.push_back(text); });
  }

  std::vector<std::string> lines_;
};

TEST_F(RetentionTest, NothingIsRemovedUnlessItIsAskedFor) {
  const auto old = Run("a.flexarm", 10000.0);
  Run("b.flexarm", 0.0);
  Remove({});
  EXPECT_TRUE(std::filesystem::exists(old));
  EXPECT_TRUE(lines_.empty());
}

TEST_F(RetentionTest, OldRunsAreRemovedAndEachIsALine) {
  const auto oldest = Run("c.flexarm", 30.0), old = Run("a.flexarm", 11.0),
             young = Run("b.flexarm", 9.0);
  Remove({.keep_days = 10.0});
  EXPECT_FALSE(std::filesystem::exists(oldest));
  EXPECT_FALSE(std::filesystem::exists(old));
  EXPECT_TRUE(std::filesystem::exists(young));
  ASSERT_EQ(lines_.size(), 2U);
  EXPECT_NE(lines_[0].find("c.flexarm: removed (log.keep_days)"), std::string::npos) << lines_[0];
}

TEST_F(RetentionTest, TheOldestAreRemovedUntilTheRestIsWithinTheSize) {
  const auto first = Run("a.flexarm", 3.0), second = Run("b.flexarm", 2.0),
             third = Run("c.flexarm", 1.0);
  const double each_mb = static_cast<double>(std::filesystem::file_size(first)) * 1e-6;
  Remove({.keep_total_mb = 2.5 * each_mb});
  EXPECT_FALSE(std::filesystem::exists(first));
  EXPECT_TRUE(std::filesystem::exists(second));
  EXPECT_TRUE(std::filesystem::exists(third));
}

TEST_F(RetentionTest, TheReportsOfALogCountWithItAndGoWithIt) {
  const auto first = Run("a.flexarm", 3.0, R"({"trip": "emergency-stop"})");
  const auto page = File("a.trip.html"), second_page = File("a.trip-2.html");
  const double log_mb = static_cast<double>(std::filesystem::file_size(first)) * 1e-6;
  WriteText(page, std::string(static_cast<std::size_t>(2e6 * log_mb), 'x'));
  WriteText(second_page, "x");
  Run("b.flexarm", 1.0);
  LogConfig config{.keep_total_mb = 2.5 * log_mb};  // two logs fit, a page of two does not beside
  Remove(config);
  EXPECT_TRUE(std::filesystem::exists(page)) << "of a trip";
  config.keep_trips = false;
  Remove(config);
  for (const auto& file : {first, page, second_page}) {
    EXPECT_FALSE(std::filesystem::exists(file)) << file;
  }
}

TEST_F(RetentionTest, TheLogOfATripStaysUnlessTheConfigSaysOtherwise) {
  const auto trip = Run("a.flexarm", 30.0, R"({"trip": "emergency-stop"})"),
             old = Run("b.flexarm", 20.0, R"({"trip": null})");
  Run("c.flexarm", 0.0);
  const LogConfig config{.keep_days = 10.0, .keep_total_mb = 1e-6};
  Remove(config);
  EXPECT_TRUE(std::filesystem::exists(trip));
  EXPECT_FALSE(std::filesystem::exists(old));
  LogConfig told = config;
  told.keep_trips = false;
  Remove(told);
  EXPECT_FALSE(std::filesystem::exists(trip));
  ASSERT_EQ(lines_.size(), 2U);
}

// Whether it tripped is not known.
TEST_F(RetentionTest, WhatAKilledProgramLeftAndWhatCannotBeReadStays) {
  {
    RunWriter writer(File("whole"), MakeInfo());
    writer.Tick(MakeTick(1));
    writer.Commit();
    std::filesystem::copy(File("whole"), File("left.flexarm"));
  }
  const auto damaged = Run("damaged.flexarm", 0.0);
  std::filesystem::resize_file(damaged, 5000);
  for (const auto& file : {File("left.flexarm"), damaged}) SetAge(file, 30.0);
  Run("new.flexarm", 0.0);
  Remove({.keep_days = 10.0, .keep_total_mb = 1e-6});
  EXPECT_TRUE(std::filesystem::exists(File("left.flexarm")));
  EXPECT_TRUE(std::filesystem::exists(damaged));
  EXPECT_TRUE(lines_.empty());
}

TEST_F(RetentionTest, TheNewestAWrittenOneAndFilesOfOthersStay) {
  const auto foreign = File("foreign.flexarm"), newest = Run("b.flexarm", 20.0);
  WriteText(foreign, "not a run");
  const auto years_ago = std::filesystem::file_time_type::clock::now() - std::chrono::years(3);
  std::filesystem::last_write_time(foreign, years_ago);
  RunWriter writing(File("live.flexarm"), MakeInfo());
  std::filesystem::last_write_time(File("live.flexarm"), years_ago);
  Remove({.keep_days = 1.0, .keep_total_mb = 1e-6});
  EXPECT_TRUE(std::filesystem::exists(foreign));
  EXPECT_TRUE(std::filesystem::exists(newest));
  EXPECT_TRUE(std::filesystem::exists(File("live.flexarm")));
}

}  // namespace
}  // namespace flexarm
