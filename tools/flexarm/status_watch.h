#pragma once

#include "tools/daemon_client/daemon_client.h"

namespace flexarm {

/// `flexarm status --watch`: shows the status once a period until q, Ctrl-C or the end of the
/// terminal. On a terminal it is a screen, else a block of lines a period; with --json one JSON
/// object a line. It goes on while no daemon answers, and says so.
/// @returns exit code
int WatchStatus(const DaemonClient& daemon, double period_s);

}  // namespace flexarm
