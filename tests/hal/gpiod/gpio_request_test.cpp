#include "hal/gpiod/gpio_request.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hal/bus_device.h"
#include "hal/gpiod/gpiod_lines.h"
#include "tests/hal/gpiod/fake_chip.h"
#include "tests/support/message_of.h"

// The driver against a chip behind libgpiod's functions, the same for both generations. With the
// library and the kernel: tests/guest/gpio_test.cpp.

namespace flexarm {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using Wire = FakeChip::Wire;

constexpr LineLevels kAll = (LineLevels{1} << kLines) - 1;

class GpioRequestTest : public testing::Test {
 protected:
  GpioRequestTest() { TheChip() = {}; }

  std::string Refusal() const {
    return MessageOf<HalError>([this] { const GpiodLines lines(config_); });
  }

  const GpiodConfig config_{
      .chip = "gpiochip0", .input = {0, 1, 2, 3, 4, 5}, .relay = 6, .pump = 7};
};

TEST_F(GpioRequestTest, EachClosedContactReadsAsItself) {
  GpiodLines lines(config_);
  EXPECT_EQ(lines.chip_name(), "gpiochip0");
  for (LineLevels closed = 0; closed <= kAll; ++closed) {
    for (std::size_t i = 0; i < kLines; ++i) {
      TheChip().wire[i] = (closed >> i & 1U) != 0 ? Wire::kClosed : Wire::kFloats;
    }
    const SafetyLines::Reading read = lines.Read(0);
    EXPECT_EQ(read.levels, closed);
    EXPECT_TRUE(read.call.ok);
  }
}

// Without a bias these pins float high, as on a processor whose pins have pull-ups after reset: a
// pulled connector would read as six closed contacts.
TEST_F(GpioRequestTest, FloatingInputsReadAsOpenBecauseTheRequestPullsThemDown) {
  TheChip().wire.fill(Wire::kFloats);
  GpiodLines lines(config_);
  EXPECT_EQ(lines.Read(0).levels, 0U);
  EXPECT_FALSE(TheChip().pulled_down[6] || TheChip().pulled_down[7]) << "outputs have no bias";
}

TEST_F(GpioRequestTest, AKernelThatRefusesThePullDownIsNamed) {
  TheChip().takes_bias = false;
  EXPECT_THAT(Refusal(), AllOf(HasSubstr("gpiod gpiochip0: the input lines cannot be requested "
                                         "with pull-down"),
                               HasSubstr("Invalid argument")));
  EXPECT_EQ(TheChip().held, decltype(TheChip().held){}) << "every line is released";
}

TEST_F(GpioRequestTest, AChipThatDoesNotReportThePullDownIsRefusedWithTheLine) {
  TheChip().reports_bias = false;
  EXPECT_THAT(
      Refusal(),
      AllOf(HasSubstr("gpiod gpiochip0: limit-1-low = line 0 does not report the pull-down"),
            HasSubstr("Use a chip and a kernel that know pull-down")));
  EXPECT_EQ(TheChip().held, decltype(TheChip().held){});
}

// What no software sees: why the circuit has its own resistors (docs/hardware.md).
TEST_F(GpioRequestTest, AChipWithoutResistorsReportsTheFlagAllTheSame) {
  TheChip().has_resistors = false;
  TheChip().wire.fill(Wire::kFloats);
  GpiodLines lines(config_);
  EXPECT_EQ(lines.Read(0).levels, kAll);
}

TEST_F(GpioRequestTest, CallsThatFailSayThatTheyFailed) {
  GpiodLines lines(config_);
  EXPECT_TRUE(lines.Write(0, {.relay_closed = true, .pump_level = false}).ok);
  EXPECT_EQ(TheChip().output[6], 1);
  EXPECT_EQ(TheChip().output[7], 0);
  TheChip().writes = false;
  EXPECT_FALSE(lines.Write(0, {.relay_closed = false, .pump_level = true}).ok);
  EXPECT_EQ(TheChip().output[6], 1);
  TheChip().reads = false;
  const SafetyLines::Reading read = lines.Read(0);
  EXPECT_FALSE(read.call.ok);
  EXPECT_EQ(read.levels, 0U) << "every contact counts as open";
}

// Closed, 1, is an open relay; a cut wire reads as a closed one.
TEST_F(GpioRequestTest, TheMirrorContactIsReadIfThereIsOne) {
  EXPECT_EQ(GpiodLines(config_).Read(0).relay, RelayContact::kNone);
  GpiodConfig config = config_;
  config.relay_contact = 8;
  GpiodLines lines(config);
  EXPECT_TRUE(TheChip().pulled_down[8]);
  EXPECT_EQ(lines.Read(0).relay, RelayContact::kOpen);
  EXPECT_EQ(lines.Read(0).levels, kAll);
  TheChip().wire[8] = Wire::kFloats;
  EXPECT_EQ(lines.Read(0).relay, RelayContact::kClosed);
  EXPECT_EQ(lines.Read(0).levels, kAll);
  TheChip().reads = false;
  EXPECT_FALSE(lines.Read(0).call.ok);
}

TEST_F(GpioRequestTest, AMirrorContactOnAUsedLineIsAConfigProblem) {
  GpiodConfig config = config_;
  config.relay_contact = config.pump;
  ASSERT_EQ(config.Problems().size(), 1U);
  EXPECT_EQ(config.Problems()[0].key, "hal.gpiod.relay_contact");
}

TEST_F(GpioRequestTest, RelayAndPumpAreLowBeforeAndAfter) {
  TheChip().output[6] = TheChip().output[7] = 1;
  {
    GpiodLines lines(config_);
    EXPECT_EQ(TheChip().output[6] + TheChip().output[7], 0);
    EXPECT_TRUE(lines.Write(0, {.relay_closed = true, .pump_level = true}).ok);
  }
  EXPECT_EQ(TheChip().output[6] + TheChip().output[7], 0);
}

TEST_F(GpioRequestTest, LinesThatAreHeldOffStayLowWhateverIsWritten) {
  GpiodLines lines(config_);
  EXPECT_TRUE(lines.Write(0, {.relay_closed = true, .pump_level = true}).ok);
  lines.HoldOff();
  EXPECT_EQ(TheChip().output[6] + TheChip().output[7], 0);
  EXPECT_TRUE(lines.Write(0, {.relay_closed = true, .pump_level = true}).ok);
  EXPECT_EQ(TheChip().output[6] + TheChip().output[7], 0);
}

TEST_F(GpioRequestTest, AHeldLineIsRefusedWithItsHolder) {
  TheChip().held[6] = true;
  EXPECT_THAT(Refusal(), HasSubstr("relay = line 6 is held by another-program"));
}

}  // namespace
}  // namespace flexarm
