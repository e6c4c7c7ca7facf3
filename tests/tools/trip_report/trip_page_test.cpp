#include "tools/trip_report/trip_page.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "controller/types/rounded_text.h"
#include "controller/types/trip_advice.h"
#include "model/units.h"
#include "tests/tools/trip_report/tripped_log.h"
#include "tools/html/html_page.h"

namespace flexarm {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class TripPageTest : public RunLogTest {
 protected:
  std::string Page(TripCause cause, const TrippedLog& log = {}) const {
    std::filesystem::remove(File());
    WriteTrippedLog(File(), cause, log);
    return TripPage(File(), 0);
  }
};

TEST_F(TripPageTest, EveryCauseHasAPageWithWhatToCheckAndItsRemedy) {
  for (int number = 1; number < kTripCauses; ++number) {
    const auto cause = static_cast<TripCause>(number);
    const std::string page = Page(cause);
    const TripAdvice advice = AdviceOf(cause);
    EXPECT_THAT(page, HasSubstr(std::string(kTripPageMark) + ToString(cause)));
    for (const char* text : {advice.happened, advice.check, advice.remedy, kAfterEveryTrip}) {
      EXPECT_THAT(page, HasSubstr(EscapedHtml(text))) << ToString(cause);
    }
  }
}

TEST_F(TripPageTest, EachSectionIsThereAndNothingIsLoaded) {
  const std::string page = Page(TripCause::kSoftLimit1);
  for (const char* section :
       {"What happened", "What to check, and how to continue", "Chain of causes",
        "What the safety machine did", "Signals of the last 10 s", "Signals before that",
        "Timing of the threads", "Buses", "Commands and events",
        "Config changes since the last good run", "The log and the program"}) {
    EXPECT_THAT(page, HasSubstr(std::string(">") + section + "</h2>"));
  }
  for (const char* loads : {"http:", "https:", "src=", "@import", "url(", "<script", "<link"}) {
    EXPECT_THAT(page, Not(HasSubstr(loads)));
  }
  // Each chart has a title and a description, which the element names.
  std::size_t charts = 0;
  for (std::size_t at = page.find("<svg"); at != std::string::npos;
       at = page.find("<svg", at + 1)) {
    ++charts;
    const std::string chart = page.substr(at, page.find("</svg>", at) - at);
    EXPECT_THAT(chart, HasSubstr("role=\"img\" aria-labelledby="));
    EXPECT_THAT(chart, HasSubstr("</title><desc"));
  }
  // 5 a joint, deflections, two residuals, payload, inputs: around the trip and before.
  EXPECT_EQ(charts, 2U * (2 * 5 + 5));
}

TEST_F(TripPageTest, ValuesAreThoseOfTheLog) {
  const std::string page =
      Page(TripCause::kSoftLimit2,
           {.evidence = {.value = 0.531, .limit = 0.524, .channel = 2, .detail = 0}});
  EXPECT_THAT(page, HasSubstr("<td>0.531 rad (30.42 deg)</td><td>0.524 rad (30.02 deg)</td>"
                              "<td>joint 2</td><td>first cause, latched</td>"));
  EXPECT_THAT(page, HasSubstr("<td>+0.000 s</td><td>Running</td><td>Tripped</td>"
                              "<td>soft-limit-2</td><td>-</td><td>is opened</td>"));
  // The trip of 12 s after a begin at noon.
  EXPECT_THAT(page, HasSubstr("2026-11-20T12:00:12Z"));
  // 10 s before the trip to its next samples: the values that MakeTick has for these ticks.
  double low = INFINITY, high = -INFINITY;
  for (std::int64_t tick = kTripTick - 500; tick < kTripTick + 100; ++tick) {
    const double deg = kDegPerRad * MakeTick(tick).output.angle_rad[0];
    low = std::min(low, deg);
    high = std::max(high, deg);
  }
  const double at_trip = kDegPerRad * MakeTick(kTripTick).output.angle_rad[0];
  EXPECT_THAT(page,
              HasSubstr("encoder: from " + RoundedText(low, 4) + " to " + RoundedText(high, 4) +
                        ", " + RoundedText(at_trip, 4) + " at the trip"));
}

TEST_F(TripPageTest, LaterCausesComeWithTheirTimeAndWhatTheDaemonSaw) {
  const std::string page =
      Page(TripCause::kLimitSwitch1Low,
           {.evidence = {.value = 0.0, .limit = 1.0, .channel = 1, .detail = 0},
            .event = {{.time_ns = kTripTick * kTestPeriodNs + 520'000'000,
                       .kind = "causes",
                       .name = "present",
                       .text = "",
                       .value_json = R"([{"name":"bus-lost","value":0.0,"limit":1.0,)"
                                     R"("bus":"can0: node 3 is silent","channel_name":""}])"}},
            .later = CauseBit(TripCause::kBusLost)});
  EXPECT_THAT(page, HasSubstr("<td>bus-lost</td><td>+0.500 s</td><td>end of the log</td>"));
  EXPECT_THAT(page, HasSubstr("<td>can0: node 3 is silent</td><td>later</td>"));
  EXPECT_THAT(page, HasSubstr(EscapedHtml(AdviceOf(TripCause::kBusLost).remedy)));
}

TEST_F(TripPageTest, ThreadsAndBusesAreThoseThatTheDaemonNoted) {
  const std::string page = Page(
      TripCause::kBusLost,
      {.event = {{.time_ns = kTripTick * kTestPeriodNs + 10'000'000,
                  .kind = "circumstances",
                  .name = "trip",
                  .text = "",
                  .value_json =
                      R"({"time_utc":"2026-11-20T12:00:13Z","before_s":10.0,)"
                      R"("threads":[{"name":"safety","activations":12000,"missed_deadlines":7,)"
                      R"("skipped_periods":0,"worst_lateness_us":81.5,"worst_run_us":20.0}],)"
                      R"("threads_before":[{"name":"safety","missed_deadlines":5}],)"
                      R"("buses":[{"name":"can0","ok":false,"fault":"no answer","failed":9,)"
                      R"("counters":{"late_bytes":3,"none":0}}],)"
                      R"("buses_before":[{"name":"can0","failed":2}]})"}}});
  EXPECT_THAT(page, HasSubstr("<td>safety</td><td>12000</td><td>7</td><td>2</td>"));
  EXPECT_THAT(page, HasSubstr("<td>can0</td><td>no</td><td>no answer</td><td>9</td><td>7</td>"));
  EXPECT_THAT(page, HasSubstr("late_bytes 3"));
  EXPECT_THAT(page, HasSubstr("2026-11-20T12:00:13Z"));
}

TEST_F(TripPageTest, WhatTheDaemonNotedMayBeAnything) {
  for (const char* json : {"", "[", "7", "null", "[1,{\"name\":2}]", "{\"threads\":{\"a\":1}}",
                           "{\"threads\":[[],{}],\"threads_before\":[3,{\"name\":[]}]}"}) {
    for (const char* kind : {"causes", "circumstances"}) {
      const std::string page =
          Page(TripCause::kSoftLimit1, {.event = {{.time_ns = kTripTick * kTestPeriodNs + 1,
                                                   .kind = kind,
                                                   .name = "trip",
                                                   .text = "",
                                                   .value_json = json}}});
      EXPECT_THAT(page, HasSubstr("</html>")) << json;
    }
  }
}

TEST_F(TripPageTest, TextsOfUsersCannotAddElements) {
  const std::string bad = "\"><script>alert(1)</script><img src=x>\x1b[2J";
  TrippedLog log;
  log.info.rig_name = bad;
  log.info.experiment_name = bad;
  log.info.label = {.name = bad, .note = bad, .tags = {bad}};
  log.event = {
      {.time_ns = 1, .kind = bad, .name = bad, .text = "stop by " + bad, .value_json = ""}};
  const std::string page = Page(TripCause::kEmergencyStop, log);
  EXPECT_THAT(page, Not(HasSubstr("<script")));
  EXPECT_THAT(page, Not(HasSubstr("<img")));
  EXPECT_THAT(page, Not(HasSubstr("\x1b")));
  EXPECT_THAT(page, HasSubstr("stop by &quot;&gt;&lt;script&gt;"));
}

TEST_F(TripPageTest, KeysThatDifferFromTheLastGoodRunAreNamed) {
  TrippedLog good;
  good.info.start_utc = "2026-11-20T11:00:00Z";
  good.info.config_text = HilRig({"limits.soft_angle_deg=[77.0,78.0]"}).text;
  const auto write = [&](const char* name, const char* result) {
    RunWriter writer(File(name), good.info);
    writer.Tick(MakeTick(0));
    writer.Close(result);
  };
  write("good.flexarm", R"({"completed":true,"trip":null})");
  good.info.config_text = HilRig({"limits.soft_angle_deg=[11.0,12.0]"}).text;
  write("tripped.flexarm", R"({"completed":false,"trip":"soft-limit-1"})");
  const std::string page = Page(TripCause::kSoftLimit1);
  EXPECT_THAT(page, HasSubstr("<td>limits.soft_angle_deg</td><td>[ 77.0, 78.0 ]</td>"));
  EXPECT_THAT(page, HasSubstr("good.flexarm of 2026-11-20T11:00:00Z"));
  EXPECT_THAT(page, Not(HasSubstr("11.0, 12.0")));
  std::filesystem::remove(File("good.flexarm"));
  EXPECT_THAT(Page(TripCause::kSoftLimit1), HasSubstr("no earlier run of this rig"));
}

TEST_F(TripPageTest, ARunWithoutATripIsRefused) {
  RunWriter writer(File(), InfoOfTrip());
  writer.Tick(MakeTick(0));
  writer.Close(R"({"completed":true,"trip":null})");
  EXPECT_THAT(MessageOf<InputError>([&] { TripPage(File(), 0); }), HasSubstr("has no trip"));
}

}  // namespace
}  // namespace flexarm
