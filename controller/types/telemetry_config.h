#pragma once

#include <string>
#include <vector>

#include "model/problem.h"

namespace flexarm {

/// Section [telemetry]: samples as UDP datagrams (docs/telemetry.md). All of it is optional.
struct TelemetryConfig {
  std::string address;  ///< of the receiver, IPv4 or IPv6 in figures; empty: there is no telemetry
  int port = 9870;      ///< of the receiver; PlotJuggler's
  int every = 1;        ///< one sample of so many is sent

  std::vector<Problem> Problems() const;
};

}  // namespace flexarm
