#include "controller/types/telemetry_config.h"

#include <gtest/gtest.h>

namespace flexarm {
namespace {

std::string KeyRefused(const TelemetryConfig& config) {
  const std::vector<Problem> problems = config.Problems();
  return problems.size() == 1 ? problems[0].key : std::to_string(problems.size()) + " problems";
}

TEST(TelemetryConfig, IsOffUnlessAnAddressIsGiven) {
  EXPECT_EQ(TelemetryConfig{}.address, "");
  EXPECT_TRUE(TelemetryConfig{}.Problems().empty());
}

TEST(TelemetryConfig, AnAddressIsOneInFigures) {
  for (const char* right : {"127.0.0.1", "192.168.7.20", "::1", "fe80::1", "239.1.2.3"}) {
    EXPECT_TRUE(TelemetryConfig{.address = right}.Problems().empty()) << right;
  }
  for (const char* wrong : {"localhost", "127.0.0", "1.2.3.4.5", "127.0.0.1:9870", " ::1", "x"}) {
    EXPECT_EQ(KeyRefused({.address = wrong}), "telemetry.address") << wrong;
  }
}

TEST(TelemetryConfig, PortAndShareAreBounded) {
  EXPECT_EQ(KeyRefused({.address = "::1", .port = 0}), "telemetry.port");
  EXPECT_EQ(KeyRefused({.address = "::1", .port = 65536}), "telemetry.port");
  EXPECT_EQ(KeyRefused({.address = "::1", .every = 0}), "telemetry.every");
  EXPECT_EQ(KeyRefused({.address = "::1", .every = 1001}), "telemetry.every");
  EXPECT_TRUE((TelemetryConfig{.address = "::1", .port = 65535, .every = 1000}).Problems().empty());
}

}  // namespace
}  // namespace flexarm
