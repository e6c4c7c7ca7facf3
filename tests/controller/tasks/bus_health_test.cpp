#include "controller/tasks/bus_health.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/loop_time.h"

namespace flexarm {
namespace {

struct Journal {
  void Follow(std::int64_t now_ns, const std::vector<BusHealth>& buses) {
    journal.Follow(now_ns, buses, [this](bool is_error, const std::string& text) {
      lines.push_back((is_error ? "error: " : "") + text);
    });
  }
  BusJournal journal;
  std::vector<std::string> lines;
};

BusHealth Bus(bool ok, const char* fault, std::uint32_t failed) {
  return {.name = "can0", .ok = ok, .fault = fault, .failed = failed, .recovered = 0};
}

TEST(BusJournal, ReportsALossAndTheReconnection) {
  Journal journal;
  journal.Follow(0, {Bus(true, "", 0)});
  journal.Follow(20 * kMs, {Bus(false, "can0: node 2 (drive2): does not answer SYNC", 2)});
  journal.Follow(40 * kMs, {Bus(false, "can0: node 2 (drive2): does not answer SYNC", 3)});
  journal.Follow(60 * kMs, {Bus(true, "", 8)});
  journal.Follow(80 * kMs, {Bus(true, "", 8)});
  EXPECT_EQ(journal.lines,
            (std::vector<std::string>{
                "error: bus lost: can0: node 2 (drive2): does not answer SYNC",
                "can0: reconnected after 6 failed exchanges and connection attempts"}));
}

// Sporadic failures without a loss of the bus are counted and reported, but not fifty times a
// second.
TEST(BusJournal, ReportsFailuresWithoutALossAtMostOnceASecond) {
  Journal journal;
  for (std::uint32_t k = 0; k < 150; ++k) {
    journal.Follow(std::int64_t{k} * 20 * kMs,
                   {Bus(true, k % 2 == 0 ? "" : "can0: no answer in time", (k + 1) / 2)});
  }
  EXPECT_EQ(journal.lines.size(), 3U);
  EXPECT_EQ(
      journal.lines[0],
      "error: can0: 1 failed exchanges without loss of the bus; the last: can0: no answer in time");
}

TEST(BusJournal, MoreThanASecondPassesBetweenTwoReports) {
  Journal journal;
  journal.Follow(0, {Bus(true, "", 1)});
  journal.Follow(1'000 * kMs, {Bus(true, "", 2)});
  EXPECT_EQ(journal.lines.size(), 1U);
  journal.Follow(1'000 * kMs + 1, {Bus(true, "", 3)});
  ASSERT_EQ(journal.lines.size(), 2U);
  EXPECT_EQ(journal.lines[1], "error: can0: 2 failed exchanges without loss of the bus");
}

// It stays until the operator resets: said once, and not as a failed exchange again and again.
TEST(BusJournal, ReportsADrivesFaultAndItsEndOnce) {
  Journal journal;
  BusHealth bus = Bus(true, "can0: node 1 (drive1): emergency message 0x2310", 1);
  bus.in_fault = true;
  journal.Follow(0, {Bus(true, "", 0)});
  for (int k = 1; k < 200; ++k) journal.Follow(k * 20 * kMs, {bus});
  journal.Follow(4'000 * kMs, {Bus(true, "", 1)});
  EXPECT_EQ(journal.lines,
            (std::vector<std::string>{
                "error: drive in fault: can0: node 1 (drive1): emergency message 0x2310. It stays "
                "so until `flexarm reset`",
                "can0: no drive is in fault any more"}));
}

TEST(BusJournal, ReportsANoticeWhenItChanges) {
  Journal journal;
  BusHealth bus = Bus(true, "", 0);
  journal.Follow(0, {bus});
  bus.notice = "can0: node 1 (drive1): has no supply while the relay is open";
  journal.Follow(20 * kMs, {bus});
  journal.Follow(40 * kMs, {bus});
  bus.notice = "";
  journal.Follow(60 * kMs, {bus});
  EXPECT_EQ(journal.lines,
            (std::vector<std::string>{"can0: node 1 (drive1): has no supply while the relay is "
                                      "open"}));
}

TEST(BusJournal, ReportsEachBusSeparately) {
  Journal journal;
  BusHealth other = Bus(true, "", 0);
  other.name = "amplifier";
  journal.Follow(0, {Bus(true, "", 0), other});
  journal.Follow(20 * kMs, {Bus(true, "", 0),
                            {.name = "amplifier",
                             .ok = false,
                             .fault = "amplifier: connection lost",
                             .failed = 2,
                             .recovered = 0}});
  EXPECT_EQ(journal.lines, std::vector<std::string>{"error: bus lost: amplifier: connection lost"});
}

}  // namespace
}  // namespace flexarm
