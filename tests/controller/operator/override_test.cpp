#include "controller/operator/override.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "controller/types/rejected_error.h"

namespace flexarm {
namespace {

using Json = nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

UnmetCondition Unmet(const std::string& name, bool may_override) {
  return {.name = name,
          .refusal = name + "-not-ready",
          .found = name + " was found wanting",
          .remedy = "mend it",
          .may_override = may_override};
}

Override Given(const std::string& condition) {
  return {.condition = condition, .reason = "because"};
}

TEST(Override, AReasonIsOneLineOfTextForPeople) {
  for (const char* reason : {"x", "emulated machine", "\"quoted\" {\"command\": \"disarm\"} \\n %s",
                             "Prüfstand, 40 °C", "\xE2\x82\xAC 1", "\xF0\x9F\x99\x82"}) {
    EXPECT_EQ(ProblemOfReason(reason), "") << reason;
  }
  EXPECT_EQ(ProblemOfReason(std::string(kLongestReason, 'x')), "");
}

TEST(Override, AReasonThatSaysNothingIsRefused) {
  for (const char* reason : {"", " ", "   ", "\xC2\xA0"}) {
    EXPECT_EQ(ProblemOfReason(reason), "is empty") << '"' << reason << '"';
  }
}

TEST(Override, AReasonIsBounded) {
  EXPECT_THAT(ProblemOfReason(std::string(kLongestReason + 1, 'x')), HasSubstr("200 bytes"));
  EXPECT_THAT(ProblemOfReason(std::string(1'000'000, '\n')), HasSubstr("200 bytes"));
}

TEST(Override, AReasonCannotBreakALineOrSteerATerminal) {
  for (const std::string& reason :
       {std::string("a\nb"), std::string("a\rb"), std::string("a\tb"), std::string("a\0b", 3),
        std::string("\x1B[2J"), std::string("a\x7F"), std::string("\xC2\x85 next line"),
        std::string("\xC2\x9B 31m"), std::string("\xE2\x80\xA8 line"),
        std::string("\xE2\x80\xAE reversed"), std::string("\xE2\x80\x8B"),
        std::string("\xE2\x81\xA6 isolated"), std::string("\xEF\xBB\xBF mark")}) {
    EXPECT_EQ(ProblemOfReason(reason), "contains a control character") << reason;
  }
}

TEST(Override, AReasonThatIsNotUtf8IsRefused) {
  for (const char* reason : {"\x80", "\xFF", "a\xC3", "\xC3(", "\xE2\x82", "\xF0\x9F\x99",
                             "\xC0\xAF", "\xE0\x80\x8A", "\xED\xA0\x80", "\xF5\x80\x80\x80"}) {
    EXPECT_EQ(ProblemOfReason(reason), "is not UTF-8") << reason;
  }
}

TEST(Override, ACommandBringsItsReasonsByCondition) {
  const Json command{{"command", "arm"}, {"overrides", {{"host", "a"}, {"design", "b"}}}};
  EXPECT_THAT(OverridesOf(command, {"host", "design"}),
              ElementsAre(Override{.condition = "host", .reason = "a"},
                          Override{.condition = "design", .reason = "b"}));
  EXPECT_THAT(OverridesOf({{"command", "arm"}}, {"host"}), IsEmpty());
}

TEST(Override, AMalformedCommandIsRefusedWithItsReason) {
  const auto problem = [](const Json& overrides) -> std::string {
    try {
      OverridesOf({{"command", "arm"}, {"overrides", overrides}}, {"host"});
    } catch (const RejectedError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(problem(Json::array({"host"})), HasSubstr("object"));
  EXPECT_THAT(problem(nullptr), HasSubstr("object"));
  EXPECT_THAT(problem({{"hots", "typo"}}), HasSubstr("'hots'"));
  EXPECT_THAT(problem({{"host", 3}}), HasSubstr("text"));
  EXPECT_THAT(problem({{"host", ""}}), HasSubstr("empty"));
  EXPECT_THAT(problem({{"host", "a\nb"}}), HasSubstr("control"));
}

TEST(Override, ARequestWhoseConditionsHoldUsesNoOverride) {
  const ConditionDecision decision = Judge({}, {Given("host"), Given("design")});
  EXPECT_EQ(decision.refused, nullptr);
  EXPECT_THAT(decision.used, IsEmpty());
}

TEST(Override, WhatDoesNotHoldRefusesUnlessItsOwnOverrideIsGiven) {
  const std::vector<UnmetCondition> unmet{Unmet("host", true), Unmet("design", true)};
  EXPECT_EQ(Judge(unmet, {}).refused, &unmet[0]);
  EXPECT_EQ(Judge(unmet, {Given("design")}).refused, &unmet[0]);
  EXPECT_EQ(Judge(unmet, {Given("host")}).refused, &unmet[1]);
  EXPECT_THAT(Judge(unmet, {Given("host")}).used, IsEmpty()) << "nothing is used by a refusal";
  const ConditionDecision both = Judge(unmet, {Given("design"), Given("host")});
  EXPECT_EQ(both.refused, nullptr);
  ASSERT_EQ(both.used.size(), 2u);
  EXPECT_EQ(both.used[0].found, "host was found wanting");
}

TEST(Override, WhatMayNotBeOverriddenRefusesAlways) {
  const std::vector<UnmetCondition> unmet{Unmet("design", false)};
  EXPECT_EQ(Judge(unmet, {Given("design")}).refused, &unmet[0]);
}

}  // namespace
}  // namespace flexarm
