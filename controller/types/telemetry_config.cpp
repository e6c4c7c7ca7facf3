#include "controller/types/telemetry_config.h"

#include <arpa/inet.h>

#include "model/problem_list.h"

namespace flexarm {
namespace {

bool InFigures(const std::string& address) {
  in6_addr parsed{};  // large enough for both
  return inet_pton(AF_INET, address.c_str(), &parsed) == 1 ||
         inet_pton(AF_INET6, address.c_str(), &parsed) == 1;
}

}  // namespace

std::vector<Problem> TelemetryConfig::Problems() const {
  ProblemList list("telemetry.");
  list.Require(address.empty() || InFigures(address), "address", address,
               "must be an IPv4 or IPv6 address in figures, such as 127.0.0.1: a name would have "
               "to be looked up while the arm moves");
  list.Within("port", port, 1, 65535, "the UDP port of the receiver");
  list.Within("every", every, 1, 1000, "one sample of so many is sent");
  return list.Take();
}

}  // namespace flexarm
