#include "tools/dashboard/command_request.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "tests/support/message_of.h"

namespace flexarm {
namespace {

using Json = nlohmann::ordered_json;
using testing::HasSubstr;

const ExperimentList kShipped{FLEXARM_SOURCE_DIR "/config/experiments"};

Json LineOf(const std::string& text) { return Json::parse(ReadCommand(text, kShipped).line); }

std::string WhyRefused(const std::string& text) {
  return MessageOf<std::runtime_error>([&] { ReadCommand(text, kShipped); });
}

TEST(CommandRequest, PassesPlainCommandsOn) {
  for (const char* name : {"stop", "disarm", "arm", "reset", "pluck"}) {
    const Json asked{{"command", name}};
    EXPECT_EQ(LineOf(asked.dump()), asked) << name;
  }
  EXPECT_TRUE(ReadCommand(R"({"command":"stop"})", kShipped).is_urgent());
  EXPECT_TRUE(ReadCommand(R"({"command":"disarm"})", kShipped).is_urgent());
  EXPECT_FALSE(ReadCommand(R"({"command":"arm"})", kShipped).is_urgent());
}

TEST(CommandRequest, TakesOverOnlyWhatNeedsTheLease) {
  EXPECT_EQ(LineOf(R"({"command":"arm","take_over":true})")["take_over"], true);
  EXPECT_FALSE(LineOf(R"({"command":"arm","take_over":false})").contains("take_over"));
  EXPECT_THAT(WhyRefused(R"({"command":"stop","take_over":true})"), HasSubstr("no key take_over"));
}

TEST(CommandRequest, AnExperimentIsSentAsItsText) {
  const Json line = LineOf(R"({"command":"run","experiment":"square-30deg.toml"})");
  EXPECT_EQ(line["command"], "run");
  EXPECT_EQ(line["name"], "square-30deg.toml");
  EXPECT_THAT(line["experiment"].get<std::string>(), HasSubstr("[[doublet]]"));
}

TEST(CommandRequest, AnExperimentIsAFileOfTheFolderAndNoPath) {
  for (const char* name : {"../hil.toml", "/etc/passwd", "", ".", "..", "square-30deg",
                           "./square-30deg.toml", "trajectory.csv"}) {
    const Json asked{{"command", "run"}, {"experiment", name}};
    EXPECT_THAT(WhyRefused(asked.dump()), HasSubstr("there is no experiment")) << name;
  }
  const ExperimentList none{{}};
  EXPECT_TRUE(none.Names().empty());
}

TEST(CommandRequest, AMoveIsTheExperimentOfTheVerbMove) {
  const Json line = LineOf(R"({"command":"move","to_deg":[20,-10.5],"duration_s":3})");
  EXPECT_EQ(line["command"], "run");
  EXPECT_EQ(line["name"], "move");
  EXPECT_EQ(line["experiment"],
            "name = \"move\"\n[[move]]\nstart_s = 0.0\nto_deg = [20, -10.5]\nduration_s = 3\n");
  EXPECT_THAT(LineOf(R"({"command":"move","to_tip_m":[0.6,0.3],"elbow":"left"})")["experiment"]
                  .get<std::string>(),
              HasSubstr("to_tip_m = [0.6, 0.3]\nelbow = \"left\""));
}

TEST(CommandRequest, NumbersAreFiniteAndWithinReason) {
  EXPECT_THAT(WhyRefused(R"({"command":"move","to_deg":[1e999,0]})"), HasSubstr("no JSON object"));
  EXPECT_THAT(WhyRefused(R"({"command":"move","to_deg":[721,0]})"), HasSubstr("to_deg"));
  EXPECT_THAT(WhyRefused(R"({"command":"move","to_deg":["20",0]})"), HasSubstr("to_deg"));
  EXPECT_THAT(WhyRefused(R"({"command":"move","to_deg":[20]})"), HasSubstr("two numbers"));
  EXPECT_THAT(WhyRefused(R"({"command":"move"})"), HasSubstr("either to_deg or to_tip_m"));
  EXPECT_THAT(WhyRefused(R"({"command":"home","joint":3,"side":"low"})"), HasSubstr("joint"));
  EXPECT_THAT(WhyRefused(R"({"command":"home","joint":1,"side":"top"})"), HasSubstr("low, high"));
}

TEST(CommandRequest, PassesNothingOnThatItDoesNotKnow) {
  EXPECT_THAT(WhyRefused(R"({"command":"zero"})"), HasSubstr("expected one of stop"));
  EXPECT_THAT(WhyRefused(R"({"command":"arm","overrides":{"host":"x"}})"),
              HasSubstr("no key overrides"));
  EXPECT_THAT(WhyRefused(R"({"command":"sim","line":"relay","level":1})"), HasSubstr("line"));
  EXPECT_THAT(WhyRefused(R"({"command":1})"), HasSubstr("expected a text"));
  EXPECT_THAT(WhyRefused("{}"), HasSubstr("command: is missing"));
  for (const char* text : {"", "[]", "null", "stop", "{\"command\":", "\xff\xfe"}) {
    EXPECT_THAT(WhyRefused(text), HasSubstr("no JSON object")) << text;
  }
}

TEST(CommandRequest, ALineIsOneLineOfAscii) {
  const std::string line =
      ReadCommand(R"({"command":"run","experiment":"trajectory.toml"})", kShipped).line;
  for (const char c : line) EXPECT_TRUE(c >= ' ' && c <= '~');
}

}  // namespace
}  // namespace flexarm
