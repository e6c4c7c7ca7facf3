#include "hal/wired/timed_lines.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "hal/bus_device.h"
#include "tests/support/message_of.h"

namespace flexarm {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::int64_t clock_ns = 0;
std::int64_t Now() noexcept { return clock_ns; }

// A chip whose calls take as long as the test says.
class SlowLines final : public SafetyLines {
 public:
  Reading Read(std::int64_t now_ns) noexcept override {
    clock_ns += read_takes_ns;
    if (slow_reads-- > 0) clock_ns += 50'000'000;
    read_at_ns = now_ns;
    return {.levels = kHealthyLevels, .call = {.ok = reads}};
  }
  Call Write(std::int64_t now_ns, const Outputs& outputs) noexcept override {
    clock_ns += write_takes_ns;
    written_at_ns = now_ns;
    closed_or_toggled = closed_or_toggled || outputs.relay_closed || outputs.pump_level;
    return {.ok = writes};
  }
  void HoldOff() noexcept override { held_off = true; }

  std::int64_t read_takes_ns = 10'000, write_takes_ns = 20'000;
  int slow_reads = 0;
  bool reads = true, writes = true;
  std::int64_t read_at_ns = -1, written_at_ns = -1;
  bool closed_or_toggled = false;
  bool held_off = false;
};

class TimedLinesTest : public testing::Test {
 protected:
  TimedLinesTest() : timed_(std::unique_ptr<SafetyLines>(chip_), Now) {}

  std::string Refusal() {
    return MessageOf<HalError>([this] { RequireQuickLines(&timed_, "gpiochip3"); });
  }

  SlowLines* chip_ = new SlowLines;  // timed_ owns it
  TimedLines timed_;
};

TEST_F(TimedLinesTest, EachCallSaysHowLongItTookAndWhetherItSucceeded) {
  const SafetyLines::Reading read = timed_.Read(7);
  EXPECT_EQ(read.levels, kHealthyLevels);
  EXPECT_EQ(read.call.took_ns, 10'000);
  EXPECT_TRUE(read.call.ok);
  EXPECT_EQ(chip_->read_at_ns, 7);
  const SafetyLines::Call write = timed_.Write(8, {.relay_closed = true, .pump_level = false});
  EXPECT_EQ(write.took_ns, 20'000);
  EXPECT_TRUE(write.ok);
  EXPECT_EQ(chip_->written_at_ns, 8);
  EXPECT_TRUE(chip_->closed_or_toggled);
  chip_->reads = chip_->writes = false;
  chip_->read_takes_ns = 50'000'000;
  EXPECT_EQ(timed_.Read(9).call.took_ns, 50'000'000);
  EXPECT_FALSE(timed_.Read(9).call.ok);
  EXPECT_FALSE(timed_.Write(9, {}).ok);
}

TEST_F(TimedLinesTest, HoldOffReachesTheLines) {
  timed_.HoldOff();
  EXPECT_TRUE(chip_->held_off);
}

TEST_F(TimedLinesTest, LinesThatAnswerInTimeAreAccepted) {
  chip_->read_takes_ns = chip_->write_takes_ns = SafetyLines::kBudgetNs;
  EXPECT_EQ(Refusal(), "");
  EXPECT_FALSE(chip_->closed_or_toggled) << "the relay stays open, the pump stands still";
}

TEST_F(TimedLinesTest, AnInterruptInAFewCallsIsNoReason) {
  chip_->slow_reads = 5;
  EXPECT_EQ(Refusal(), "");
}

TEST_F(TimedLinesTest, ReadsOf50MsAreRefused) {
  chip_->read_takes_ns = 50'000'000;
  EXPECT_THAT(Refusal(), AllOf(HasSubstr("gpiod gpiochip3: a read of the lines takes 50000 us"),
                               HasSubstr("must be 200 us at most"),
                               HasSubstr("lines of the processor itself")));
}

TEST_F(TimedLinesTest, WritesOf50MsAreRefused) {
  chip_->write_takes_ns = 50'000'000;
  EXPECT_THAT(Refusal(), HasSubstr("gpiod gpiochip3: a write of the lines takes 50000 us"));
}

TEST_F(TimedLinesTest, CallsJustOverTheBudgetAreRefused) {
  chip_->read_takes_ns = SafetyLines::kBudgetNs + 1;
  EXPECT_THAT(Refusal(), HasSubstr("a read of the lines takes 200 us"));
}

TEST_F(TimedLinesTest, CallsThatFailAreRefused) {
  chip_->writes = false;
  EXPECT_THAT(Refusal(), HasSubstr("gpiod gpiochip3: a write of the lines failed"));
  chip_->reads = false;
  EXPECT_THAT(Refusal(), HasSubstr("gpiod gpiochip3: a read of the lines failed"));
}

}  // namespace
}  // namespace flexarm
