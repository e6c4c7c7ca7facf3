#pragma once

#include <string>

#include "tools/status/reply.h"

namespace flexarm {

/// What `flexarm status` prints: the answer to the command "status" for people. Of a daemon of
/// another version it shows what it knows. Pure function.
std::string StatusText(const Reply& status);

/// The progress of a run as a line: "square: 12.3 of 30.0 s". @param run  key "run" of a status
std::string ProgressText(const Reply& run);

/// "to 127.0.0.1 port 9870, 12 sent, 0 lost; what is wrong". @param telemetry  key of a status
std::string TelemetryText(const Reply& telemetry);

/// What broke a limit: "value 0.531, limit 0.524, joint 1", or what a bus says; empty: nothing is
/// known. @param cause  key "trip", or one of "present"
std::string EvidenceText(const Reply& cause);

}  // namespace flexarm
