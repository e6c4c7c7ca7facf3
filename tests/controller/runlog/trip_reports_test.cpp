#include "controller/runlog/trip_reports.h"

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <csignal>
#include <filesystem>
#include <stdexcept>

#include "controller/runlog/run_finisher.h"
#include "controller/runlog/trips_of_run.h"
#include "tests/controller/runlog/runlog_fixture.h"

namespace flexarm {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr std::int64_t kTripNs = 1'000'000;

class TripReportsTest : public RunLogTest {
 protected:
  // A log that trips in Armed at the given instants, each after a reset.
  void WriteLog(const std::string& name, const std::vector<std::int64_t>& trips_ns,
                bool close = true) {
    RunWriter writer(File(name), MakeInfo());
    writer.Tick(MakeTick(0));
    for (const std::int64_t at_ns : trips_ns) {
      writer.Safety(MakeSafety(at_ns, {SafetyState::kArmed, TripCause::kNone}, RequestKind::kNone,
                               CauseBit(TripCause::kEmergencyStop)));
    }
    if (trips_ns.empty()) {
      writer.Safety(MakeSafety(kTripNs, kIdleStatus, RequestKind::kArm));
    }
    const std::string trip = trips_ns.empty() ? "null" : R"("emergency-stop")";
    if (close) writer.Close(R"({"completed":false,"trip":)" + trip + "}");
  }
  std::vector<std::string> Pages() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
      if (entry.path().extension() == ".html") names.push_back(entry.path().filename().string());
    }
    std::ranges::sort(names);
    return names;
  }

  std::vector<std::string> errors_;
  TripReports reports_{[](const std::filesystem::path& log, std::size_t number) {
                         return log.stem().string() + " trip " + std::to_string(number);
                       },
                       [this](bool is_error, const std::string& text) {
                         if (is_error) errors_.push_back(text);
                       }};
};

TEST_F(TripReportsTest, EachTripOfARunHasAPageAndNoneReplacesAnother) {
  WriteLog("a.flexarm", {kTripNs, 3 * kTripNs});
  WriteText(File("a.trip.html"), "of another program");
  reports_.Closed(File("a.flexarm"));
  EXPECT_THAT(Pages(), ElementsAre("a.trip-2.html", "a.trip-3.html", "a.trip.html"));
  EXPECT_EQ(Bytes(File("a.trip.html")), "of another program");
  EXPECT_EQ(Bytes(File("a.trip-2.html")), "a trip 0");
  EXPECT_EQ(Bytes(File("a.trip-3.html")), "a trip 1");
  EXPECT_EQ(reports_.newest().file, File("a.trip-3.html"));
  EXPECT_EQ(reports_.newest().trip_ns, 3 * kTripNs);
  EXPECT_THAT(errors_, ElementsAre());
}

TEST_F(TripReportsTest, ARunWithoutATripHasNone) {
  WriteLog("a.flexarm", {});
  reports_.Closed(File("a.flexarm"));
  EXPECT_THAT(Pages(), ElementsAre());
  EXPECT_TRUE(reports_.newest().file.empty());
}

TEST_F(TripReportsTest, TheFinisherWritesThePageOnceTheRunIsClosed) {
  RunFinisher finisher([](bool, const std::string&) {}, &reports_);
  RunWriter writer(File(), MakeInfo());
  writer.Tick(MakeTick(0));
  writer.Safety(MakeSafety(kTripNs, {SafetyState::kArmed, TripCause::kNone}, RequestKind::kNone,
                           CauseBit(TripCause::kEmergencyStop)));
  finisher.Add(writer.End(R"({"completed":false,"trip":"emergency-stop"})"));
  finisher.Stop();
  EXPECT_THAT(Pages(), ElementsAre("run.trip.html"));
}

// A limit on the size of files stands for a full disk: the write fails in the same place.
TEST_F(TripReportsTest, AFullDiskIsToldOnceAndThePageComesWhenThereIsRoom) {
  WriteLog("a.flexarm", {kTripNs});
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  rlimit none = before;
  none.rlim_cur = 0;
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &none), 0);
  reports_.Closed(File("a.flexarm"));
  EXPECT_FALSE(reports_.Try());
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  ASSERT_EQ(errors_.size(), 1U);
  EXPECT_THAT(errors_[0], HasSubstr("a.trip.html"));
  EXPECT_THAT(Pages(), ElementsAre()) << "nothing half written";
  EXPECT_TRUE(reports_.Try());
  EXPECT_EQ(Bytes(File("a.trip.html")), "a trip 0");
}

TEST_F(TripReportsTest, APageThatCannotBeMadeIsToldAndStopsNothing) {
  WriteLog("a.flexarm", {kTripNs});
  TripReports broken(
      [](const auto&, std::size_t) -> std::string { throw std::runtime_error("no"); },
      [this](bool, const std::string& text) { errors_.push_back(text); });
  broken.Closed(File("a.flexarm"));
  EXPECT_TRUE(broken.Try());
  ASSERT_EQ(errors_.size(), 1U);
  EXPECT_THAT(errors_[0], HasSubstr("a.flexarm: no"));
}

TEST_F(TripReportsTest, TheReportOfADaemonBeforeIsFoundOrMade) {
  WriteLog("a.flexarm", {kTripNs});
  reports_.Recall(folder_, "soft-limit-1");
  EXPECT_THAT(Pages(), ElementsAre()) << "another trip";
  reports_.Recall(folder_, "emergency-stop");
  EXPECT_THAT(Pages(), ElementsAre("a.trip.html"));
  EXPECT_EQ(reports_.newest().file, File("a.trip.html"));
  reports_.Recall(folder_, "emergency-stop");
  EXPECT_THAT(Pages(), ElementsAre("a.trip.html"));
}

TEST_F(TripReportsTest, ARunThatWasKilledWhileArmedTripsTheNextDaemon) {
  {
    RunWriter writer(File(), MakeInfo());
    writer.Tick(MakeTick(0));
    writer.Tick(MakeTick(1));
    writer.Safety(MakeSafety(kTripNs, kIdleStatus, RequestKind::kArm));
    writer.Commit();
  }  // without a result, as a killed program leaves it
  const std::vector<SafetyRecord> trips = TripsOfRun(File());
  ASSERT_EQ(trips.size(), 1U);
  EXPECT_EQ(trips[0].after.cause, TripCause::kEndedWhileArmed);
  EXPECT_EQ(trips[0].before.state, SafetyState::kArmed);
  EXPECT_EQ(trips[0].due_ns, kTestPeriodNs) << "the last sample";
}

}  // namespace
}  // namespace flexarm
