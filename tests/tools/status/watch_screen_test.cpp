#include "tools/status/watch_screen.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "controller/types/safety_state.h"
#include "controller/types/trip_cause.h"
#include "tests/tools/status/watched.h"
#include "tools/status/display_text.h"

namespace flexarm {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string Screen(const WatchedStatus& watched, const ScreenSize& size,
                   const ScreenStyle& style = kPlainUtf8) {
  return Joined(WatchScreen(watched, size, style));
}

std::string FileText(const std::filesystem::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

// Screens that a person has looked at. One that differs is written beside the build: look at it,
// and copy it to tests/golden/watch if it is right.
void ExpectGolden(const std::string& name, const std::string& screen) {
  const std::filesystem::path made = std::filesystem::path(FLEXARM_BINARY_DIR) / "watch" / name;
  if (FileText(WatchGolden(name)) == screen) return;
  std::filesystem::create_directories(made.parent_path());
  std::ofstream(made) << screen;
  ADD_FAILURE() << "differs from " << WatchGolden(name) << ", see " << made << "\n" << screen;
}

// As the safety machine and the operator task tell it.
Reply InState(SafetyState state) {
  Reply status = RunningStatus();
  status["state"] = ToString(state);
  status["relay_closed"] = RelayClosed(state);
  if (!TorqueAllowed(state)) status["torque_source"] = status["reference_deg"] = nullptr;
  if (!TorqueAllowed(state)) status["run"]["outcome"] = "done";
  if (state == SafetyState::kStopping || state == SafetyState::kFaultStopping) {
    status["torque_source"] = "stop-controller";
  }
  if (CauseLatched(state)) {
    status["trip"] = {{"name", ToString(TripCause::kBendingStrain1)},
                      {"text", OperatorText(TripCause::kBendingStrain1)},
                      {"value", 0.0022},
                      {"limit", 0.0019},
                      {"channel_name", "joint 1"}};
  }
  return status;
}

TEST(WatchScreen, ARunAtThreeSizes) {
  const WatchedStatus running = Watched(RunningStatus());
  ExpectGolden("running-80x24.txt", Screen(running, {.columns = 80, .rows = 24}));
  ExpectGolden("running-120x40.txt", Screen(running, {.columns = 120, .rows = 40}));
  ExpectGolden("running-40x15.txt", Screen(running, {.columns = 40, .rows = 15}));
}

TEST(WatchScreen, WithColoursAndInAscii) {
  const WatchedStatus running = Watched(RunningStatus());
  const ScreenSize size{.columns = 80, .rows = 24};
  ExpectGolden("colours-80x24.txt", Screen(running, size, {.colour = true, .utf8 = true}));
  const std::string ascii = Screen(running, size, {.colour = false, .utf8 = false});
  ExpectGolden("ascii-80x24.txt", ascii);
  for (const char sign : ascii) ASSERT_TRUE(sign == '\n' || (sign >= ' ' && sign <= '~')) << ascii;
}

TEST(WatchScreen, EachStateOfTheSafetyMachine) {
  std::string all;
  for (int i = 0; i < kSafetyStates; ++i) {
    const Reply status = InState(static_cast<SafetyState>(i));
    const std::vector<std::string> lines =
        WatchScreen(Watched(status), {.columns = 80, .rows = 24}, kPlainUtf8);
    EXPECT_LE(lines.size(), 24u);
    const std::size_t head = status["trip"].is_null() ? 3 : 5;  // with the lamps
    all += Joined({lines.begin(), lines.begin() + static_cast<std::ptrdiff_t>(head)}) + "\n";
  }
  ExpectGolden("states-80.txt", all);
}

TEST(WatchScreen, ATripIsTheLastThatIsLeftOut) {
  const Reply tripped = InState(SafetyState::kTripped);
  ExpectGolden("tripped-80x24.txt", Screen(Watched(tripped), {.columns = 80, .rows = 24}));
  const std::string small = Screen(Watched(tripped), {.columns = 40, .rows = 4});
  EXPECT_THAT(small, HasSubstr("Tripped"));
  EXPECT_THAT(small, HasSubstr("TRIP bending-strain-1"));
}

TEST(WatchScreen, WhateverIsMissingTheRestIsShown) {
  const Reply whole = RunningStatus();
  for (const auto& [key, value] : whole.items()) {
    for (const Reply& other : {Reply(nullptr), Reply(true), Reply("x"), Reply(-1e300),
                               Reply::array({nullptr, "x"}), Reply::object()}) {
      Reply changed = whole;
      changed[key] = other;
      const std::string screen = Screen(Watched(changed), {.columns = 80, .rows = 24});
      const bool named = screen.find("Running") != std::string::npos;
      EXPECT_TRUE(named || key == "state") << key << " " << other;
    }
  }
  ExpectGolden("nothing-80x24.txt", Screen(Watched(Reply::object()), {.columns = 80, .rows = 24}));
}

TEST(WatchScreen, NoLineIsWiderAndNoScreenHigherThanTheTerminal) {
  Reply status = InState(SafetyState::kTripped);
  status["rig"] =
      "Pr\xC3\xBC"
      "fstand \xE8\x87\x82";  // a sign of two columns
  status["run"]["name"] = "\xE4\xB8\x80\xE4\xBA\x8C\xE4\xB8\x89";
  for (int columns = 1; columns <= 200; ++columns) {
    for (const int rows : {1, 2, 5, 10, 15, 24, 40, 80}) {
      const auto lines =
          WatchScreen(Watched(status), {.columns = columns, .rows = rows}, kPlainUtf8);
      ASSERT_LE(static_cast<int>(lines.size()), rows) << columns;
      for (const std::string& line : lines) ASSERT_LE(DisplayWidth(line), columns) << line;
    }
  }
}

TEST(WatchScreen, WithoutAnAnswerItSaysHowOldTheValuesAre) {
  WatchedStatus lost = Watched(RunningStatus());
  lost.no_answer = "/run/flexarm/flexarmd.sock: the daemon does not answer";
  lost.age_s = 3.2;
  const std::string screen = Screen(lost, {.columns = 80, .rows = 24});
  EXPECT_THAT(screen, HasSubstr("NO ANSWER: what follows is 3.2 s old"));
  EXPECT_THAT(screen, HasSubstr("does not answer"));
  EXPECT_THAT(screen, HasSubstr("Running")) << "the last values stay";
  lost.status = nullptr;
  const std::string never = Screen(lost, {.columns = 80, .rows = 24});
  EXPECT_THAT(never, HasSubstr("NO ANSWER\n"));
  EXPECT_THAT(never, Not(HasSubstr("relay"))) << "nothing is known";
}

TEST(WatchScreen, WhatIsOldIsMarkedWithItsAge) {
  const ScreenSize size{.columns = 80, .rows = 24};
  EXPECT_THAT(Screen(Watched(RunningStatus()), size), Not(HasSubstr(" old")));
  Reply status = RunningStatus();
  status["tick_age_ms"] = 2500.0;
  status["permit_age_ms"] = 150.0;
  status["gauges"][3]["age_ms"] = 640.0;
  status["encoders"][1]["age_ms"] = 100.0;  // the bound itself
  const std::string screen = Screen(Watched(status), size);
  EXPECT_THAT(screen, HasSubstr("sample 2.5 s old"));
  EXPECT_THAT(screen, HasSubstr("permit 150 ms old"));
  EXPECT_THAT(screen, HasSubstr("04   [640 ms old"));
  EXPECT_THAT(screen, HasSubstr("100 ms old")) << screen;
}

TEST(WatchScreen, AChannelThatDriftsIsShown) {
  Reply status = RunningStatus();
  const ScreenSize size{.columns = 100, .rows = 50};
  status["health"] = {{"alarms", Reply::array()}};
  EXPECT_THAT(Screen(Watched(status), size), Not(HasSubstr("health")));
  status["health"]["alarms"].push_back(
      {{"channel", "link1.gauge7.gain"}, {"text", "gauge 7 of link 1: gain 4.1 %"}});
  EXPECT_THAT(Screen(Watched(status), size), HasSubstr("health gauge 7 of link 1: gain 4.1 %"));
}

TEST(WatchScreen, TelemetryIsShownWhereItIsOn) {
  const ScreenSize size{.columns = 80, .rows = 40};
  EXPECT_THAT(Screen(Watched(RunningStatus()), size), Not(HasSubstr("telemetry")));
  Reply status = RunningStatus();
  status["telemetry"] = {{"address", "::1"},
                         {"port", 9870},
                         {"sent", 12},
                         {"lost", 3},
                         {"error", "Network is unreachable"}};
  EXPECT_THAT(Screen(Watched(status), size),
              HasSubstr("telemetry to ::1 port 9870, 12 sent, 3 lost; Network is unreachable"));
}

TEST(WatchScreen, WhatTheFitDoesWithoutIsMarked) {
  Reply status = RunningStatus();
  status["gauges"][4]["used"] = false;
  const auto wide = Screen(Watched(status), {.columns = 80, .rows = 24});
  EXPECT_THAT(wide, testing::ContainsRegex("\n05 [^\n]*[+]525 ! 05"));
  const auto narrow = Screen(Watched(status), {.columns = 40, .rows = 15});
  EXPECT_THAT(narrow, HasSubstr(" !! "));
}

TEST(WatchScreen, SwitchesAndCountersAreThereWhileTheArmIsDisarmed) {
  Reply status = InState(SafetyState::kIdle);
  status["inputs"]["limit-2-high"] = 0;
  status["inputs"]["reset-button"] = 1;
  status["encoders"][0]["counts"] = -123456;
  status["joint_angle_deg"] = {nullptr, nullptr};
  const std::string screen = Screen(Watched(status), {.columns = 80, .rows = 24});
  EXPECT_THAT(screen, HasSubstr("2 high OPEN"));
  EXPECT_THAT(screen, HasSubstr("reset PRESSED"));
  EXPECT_THAT(screen, HasSubstr("hub1 -123456 counts"));
  EXPECT_THAT(screen, HasSubstr("unknown deg"));
  EXPECT_THAT(screen, HasSubstr("angle is not known"));
}

}  // namespace
}  // namespace flexarm
