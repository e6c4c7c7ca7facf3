#pragma once

#include "tools/daemon_client/daemon_client.h"
#include "tools/status/reply.h"

namespace flexarm {

/// Sends the command `run`, waits for the end of the run, shows its progress, and says how it
/// ended: a bar on a terminal, a line every 5 s elsewhere, nothing with --json but the last status
/// of the run.
///
/// Ctrl-C (SIGINT) and SIGTERM stop the run, also while it is planned, and its end is waited for;
/// another one leaves it to itself.
/// @param within_s  for the planning
/// @returns exit code: kDone if the run ended as planned, else kFailed, with the reason on stderr
/// @throws RejectedError, InputError if no daemon takes the command
int RunAndWait(const DaemonClient& daemon, const Reply& command, double within_s);

}  // namespace flexarm
