#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>

#include "controller/host/crash_handler.h"
#include "hal/bus_device.h"
#include "hal/gpiod/gpio_request.h"
#include "hal/gpiod/gpiod_lines.h"
#include "hal/line_names.h"
#include "hal/wired/chip_bus.h"
#include "tests/support/message_of.h"
#include "tests/support/no_alloc.h"

// Inside the guest (gpio.sh starts it there): the driver of the safety lines, the installed
// libgpiod and the kernel against a chip of gpio-sim. The same tests hold for both generations of
// libgpiod: Debian 12 has the first, Debian 13 the second.
//
// gpio-sim (drivers/gpio/gpio-sim.c): `pull` of a line is the level that an input reads, `value`
// the level that an output drives. The chip disappears when 0 is written to `live`.

namespace flexarm {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr int kChipLines = 8;
constexpr LineLevels kAllClosed = (LineLevels{1} << kLines) - 1;

std::string FirstLineOf(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  return line;
}

// A simulated chip with the label "plc".
class SimulatedChip {
 public:
  SimulatedChip() {
    std::filesystem::create_directories(bank_);
    Put(bank_ / "num_lines", std::to_string(kChipLines));
    Put(bank_ / "label", "plc");
    Put(device_ / "live", "1");
    name_ = FirstLineOf(bank_ / "chip_name");
    lines_ = std::filesystem::path("/sys/devices/platform") / FirstLineOf(device_ / "dev_name") /
             name_ / "sim_gpio";
  }
  ~SimulatedChip() {
    if (live_) Remove();
    std::filesystem::remove(bank_);
    std::filesystem::remove(device_);
  }
  SimulatedChip(const SimulatedChip&) = delete;
  SimulatedChip& operator=(const SimulatedChip&) = delete;

  const std::string& name() const { return name_; }  // "gpiochip0"
  GpiodConfig Config() const {
    return {.chip = "/dev/" + name_, .input = {0, 1, 2, 3, 4, 5}, .relay = 6, .pump = 7};
  }

  // The contact at an input, as its pull resistor: closed is 1.
  void SetContact(int line, bool closed) const {
    Put(AttributeOf(line, "pull"), closed ? "pull-up" : "pull-down");
  }
  void SetContacts(LineLevels closed) const {
    for (int i = 0; i < kLines; ++i) SetContact(i, (closed >> i & 1U) != 0);
  }
  std::string PullOf(int line) const { return FirstLineOf(AttributeOf(line, "pull")); }
  std::string LevelOf(int line) const { return FirstLineOf(AttributeOf(line, "value")); }

  // As if a USB adapter were unplugged.
  void Remove() {
    Put(device_ / "live", "0");
    live_ = false;
  }

 private:
  static void Put(const std::filesystem::path& file, const std::string& text) {
    std::ofstream out(file);
    out << text << std::flush;
    EXPECT_TRUE(out.good()) << file;
  }
  std::filesystem::path AttributeOf(int line, const std::string& attribute) const {
    return lines_.string() + std::to_string(line) + "/" + attribute;
  }

  std::filesystem::path device_ = "/sys/kernel/config/gpio-sim/gpio-test";
  std::filesystem::path bank_ = device_ / "bank";
  std::string name_;
  std::filesystem::path lines_;
  bool live_ = true;
};

class GpioInGuest : public testing::Test {
 protected:
  SimulatedChip chip_;
};

TEST_F(GpioInGuest, EachContactIsReadAsItsOwnLine) {
  GpiodLines lines(chip_.Config());
  for (LineLevels closed = 0; closed <= kAllClosed; ++closed) {
    chip_.SetContacts(closed);
    EXPECT_EQ(lines.Read(0).levels, closed);
  }
}

// A read takes the level, not the events: many edges before it change nothing.
TEST_F(GpioInGuest, AnEdgeIsSeenByTheNextReadHoweverManyCameBefore) {
  GpiodLines lines(chip_.Config());
  chip_.SetContacts(kAllClosed);
  for (int edges = 0; edges < 100; ++edges) {
    chip_.SetContact(2, false);
    chip_.SetContact(2, true);
  }
  EXPECT_EQ(lines.Read(0).levels, kAllClosed);
  chip_.SetContact(2, false);
  EXPECT_EQ(lines.Read(0).levels, kAllClosed & ~(LineLevels{1} << 2));
}

// After reset the pins of some processors have pull-ups: a floating input reads as a closed
// contact.
TEST_F(GpioInGuest, AFloatingInputIsPulledDownByTheRequestAndReadsAsAnOpenContact) {
  chip_.SetContacts(kAllClosed);
  GpiodLines lines(chip_.Config());
  EXPECT_EQ(lines.Read(0).levels, 0U);
  for (int i = 0; i < kLines; ++i) EXPECT_EQ(chip_.PullOf(i), "pull-down") << "line " << i;
}

TEST_F(GpioInGuest, TheOutputsKeepTheirBias) {
  chip_.SetContact(6, true);
  const GpiodLines lines(chip_.Config());
  EXPECT_EQ(chip_.PullOf(6), "pull-up");
}

TEST_F(GpioInGuest, RelayAndPumpStartLowAndDriveTheirOwnLines) {
  chip_.SetContact(6, true);  // a pull-up at the output must not close the relay
  chip_.SetContact(7, true);
  GpiodLines lines(chip_.Config());
  EXPECT_EQ(chip_.LevelOf(6) + chip_.LevelOf(7), "00");
  EXPECT_TRUE(lines.Write(0, {.relay_closed = true, .pump_level = false}).ok);
  EXPECT_EQ(chip_.LevelOf(6) + chip_.LevelOf(7), "10");
  EXPECT_TRUE(lines.Write(0, {.relay_closed = false, .pump_level = true}).ok);
  EXPECT_EQ(chip_.LevelOf(6) + chip_.LevelOf(7), "01");
  EXPECT_TRUE(lines.Write(0, {.relay_closed = true, .pump_level = true}).ok);
  EXPECT_EQ(chip_.LevelOf(6) + chip_.LevelOf(7), "11");
}

// A kernel may leave the lines of a dead process as they were. Here this process holds them, too,
// so the death of the other one does not release them: only its crash handler can have set them
// low.
TEST_F(GpioInGuest, ACrashSetsRelayAndPumpLowBeforeTheProcessEnds) {
  GpiodLines lines(chip_.Config());
  ASSERT_TRUE(lines.Write(0, {.relay_closed = true, .pump_level = true}).ok);
  ASSERT_EQ(chip_.LevelOf(6) + chip_.LevelOf(7), "11");
  const pid_t crashing = fork();
  if (crashing == 0) {
    const CrashHandler handler(
        {.call = [](void* held) noexcept { static_cast<GpiodLines*>(held)->HoldOff(); },
         .context = &lines});
    raise(SIGSEGV);
    _exit(0);
  }
  int status = 0;
  ASSERT_EQ(waitpid(crashing, &status, 0), crashing);
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGSEGV) << status;
  EXPECT_EQ(chip_.LevelOf(6) + chip_.LevelOf(7), "00");
}

TEST_F(GpioInGuest, OutputsDoNotDisturbInputs) {
  GpiodLines lines(chip_.Config());
  chip_.SetContacts(0b101001);
  for (const bool relay : {false, true}) {
    for (const bool pump : {false, true}) {
      EXPECT_TRUE(lines.Write(0, {.relay_closed = relay, .pump_level = pump}).ok);
      EXPECT_EQ(lines.Read(0).levels, 0b101001U);
    }
  }
}

TEST_F(GpioInGuest, TheChipIsFoundByItsPathNameAndLabel) {
  for (const std::string& wanted : {"/dev/" + chip_.name(), chip_.name(), std::string("plc")}) {
    GpiodConfig config = chip_.Config();
    config.chip = wanted;
    GpiodLines lines(config);
    chip_.SetContacts(0b000010);
    EXPECT_EQ(lines.Read(0).levels, 0b000010U) << wanted;
    EXPECT_EQ(lines.chip_name(), chip_.name()) << wanted;
    EXPECT_NO_THROW(RequireDirectChip(lines.chip_name())) << "it is on no slow bus";
  }
}

TEST_F(GpioInGuest, AHeldLineIsRefusedWithTheNameOfItsHolder) {
  const GpiodLines holder(chip_.Config());
  EXPECT_THAT(MessageOf<HalError>([&] { const GpiodLines second(chip_.Config()); }),
              AllOf(HasSubstr("gpiod /dev/" + chip_.name()), HasSubstr(ToString(Line{})),
                    HasSubstr("line 0 is held by flexarmd")));
}

TEST_F(GpioInGuest, ReleasedLinesCanBeTakenAgain) {
  for (int i = 0; i < 3; ++i) {
    GpiodLines lines(chip_.Config());
    EXPECT_TRUE(lines.Write(0, {.relay_closed = true, .pump_level = true}).ok);
  }
  const GpiodLines again(chip_.Config());
  EXPECT_EQ(chip_.LevelOf(6) + chip_.LevelOf(7), "00");
}

TEST_F(GpioInGuest, ALineThatTheChipDoesNotHaveIsNamed) {
  GpiodConfig config = chip_.Config();
  config.pump = kChipLines;
  EXPECT_THAT(MessageOf<HalError>([&] { const GpiodLines lines(config); }),
              HasSubstr("pump = line 8 does not exist"));
}

// The chip is gone while its lines are held: both calls say so, and every contact counts as open.
TEST_F(GpioInGuest, ALostChipReadsAsOpenContactsAndFailsToWrite) {
  GpiodLines lines(chip_.Config());
  chip_.SetContacts(kAllClosed);
  EXPECT_EQ(lines.Read(0).levels, kAllClosed);
  EXPECT_TRUE(lines.Write(0, {.relay_closed = true, .pump_level = true}).ok);
  chip_.Remove();
  const SafetyLines::Reading lost = lines.Read(0);
  EXPECT_EQ(lost.levels, 0U);
  EXPECT_FALSE(lost.call.ok);
  EXPECT_FALSE(lines.Write(0, {.relay_closed = true, .pump_level = true}).ok);
  EXPECT_THAT(MessageOf<HalError>([&] { const GpiodLines again(chip_.Config()); }),
              HasSubstr("cannot be opened"));
}

TEST_F(GpioInGuest, ARequestReportsWhatTheKernelRefuses) {
  GpioRequest request(chip_.Config());
  std::array<int, kMostGpioInputs> levels{};
  EXPECT_TRUE(request.Read(&levels));
  EXPECT_TRUE(request.Write(1, 1));
  chip_.Remove();
  EXPECT_FALSE(request.Read(&levels));
  EXPECT_FALSE(request.Write(0, 0));
}

TEST_F(GpioInGuest, ReadingAndWritingDoNotAllocate) {
  ASSERT_TRUE(kNoAllocWorks);
  GpiodLines lines(chip_.Config());
  const NoAlloc guard;
  for (int i = 0; i < 10; ++i) {
    static_cast<void>(lines.Write(0, {.relay_closed = true, .pump_level = i % 2 == 0}));
    static_cast<void>(lines.Read(0));
  }
}

}  // namespace
}  // namespace flexarm
