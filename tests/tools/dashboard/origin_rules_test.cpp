#include "tools/dashboard/origin_rules.h"

#include <gtest/gtest.h>

namespace flexarm {
namespace {

const OriginRules kRules{ListenAddress{.ip = "127.0.0.1", .port = 8080}};

TEST(OriginRules, HostIsThisComputerWithThePort) {
  for (const char* host : {"127.0.0.1:8080", "localhost:8080", "[::1]:8080", "LocalHost:8080"}) {
    EXPECT_EQ(kRules.WhyNotAnswered({.host = host}), "") << host;
  }
  for (const char* host : {"", "127.0.0.1", "localhost", "127.0.0.1:80", "127.0.0.1:80800",
                           "rig.example:8080", "localhost:8080.rig.example", "localhost.:8080",
                           "127.0.0.1:8080, rig.example", "::1:8080", " localhost:8080"}) {
    EXPECT_NE(kRules.WhyNotAnswered({.host = host}), "") << host;
  }
  EXPECT_NE(kRules.WhyNotAnswered({}), "") << "no Host at all";
}

// The name of another site that points at 127.0.0.1: Host and Origin agree, and are foreign.
TEST(OriginRules, ANameThatWasPointedAtThisComputerIsRefused) {
  const RequestSource rebound{.host = "rig.example:8080", .origin = "http://rig.example:8080"};
  EXPECT_NE(kRules.WhyNotAnswered(rebound), "");
  EXPECT_NE(kRules.WhyNotShown(rebound), "");
  EXPECT_NE(kRules.WhyNotCommanded(rebound), "");
}

TEST(OriginRules, ValuesAreShownToThisPageAndToProgramsWithoutAnOrigin) {
  RequestSource source{.host = "localhost:8080"};
  EXPECT_EQ(kRules.WhyNotShown(source), "");
  source.origin = "http://localhost:8080";
  EXPECT_EQ(kRules.WhyNotShown(source), "");
  for (const char* origin :
       {"http://rig.example", "null", "", "https://localhost:8080", "http://localhost:8081",
        "http://localhost", "localhost:8080", "http://127.0.0.1:8080", "http://localhost:8080/"}) {
    source.origin = origin;
    EXPECT_NE(kRules.WhyNotShown(source), "") << origin;
  }
}

TEST(OriginRules, AnotherSiteIsNotShownValuesAlsoWithoutAnOrigin) {
  for (const char* site : {"cross-site", "same-site"}) {
    EXPECT_NE(kRules.WhyNotShown({.host = "localhost:8080", .sec_fetch_site = site}), "") << site;
  }
  for (const char* site : {"same-origin", "none"}) {
    EXPECT_EQ(kRules.WhyNotShown({.host = "localhost:8080", .sec_fetch_site = site}), "") << site;
  }
}

TEST(OriginRules, ACommandNeedsTheOriginOfThisPage) {
  RequestSource source{.host = "127.0.0.1:8080"};
  EXPECT_NE(kRules.WhyNotCommanded(source), "") << "no Origin";
  source.origin = "http://localhost:8080";
  EXPECT_NE(kRules.WhyNotCommanded(source), "") << "not the same name as Host";
  source.origin = "http://127.0.0.1:8080";
  EXPECT_EQ(kRules.WhyNotCommanded(source), "");
}

TEST(OriginRules, PortEightyMayBeLeftOut) {
  const OriginRules rules(ListenAddress{.ip = "127.0.0.1", .port = 80});
  EXPECT_EQ(rules.WhyNotCommanded({.host = "localhost", .origin = "http://localhost"}), "");
  EXPECT_EQ(rules.WhyNotAnswered({.host = "localhost:80"}), "");
}

TEST(OriginRules, AnAddressThatOthersReachIsTheOnlyHost) {
  const OriginRules rules(ListenAddress{.ip = "192.0.2.7", .port = 8080});
  EXPECT_EQ(rules.WhyNotAnswered({.host = "192.0.2.7:8080"}), "");
  EXPECT_NE(rules.WhyNotAnswered({.host = "localhost:8080"}), "");
}

}  // namespace
}  // namespace flexarm
