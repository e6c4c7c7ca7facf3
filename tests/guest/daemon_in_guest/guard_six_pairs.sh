#!/usr/bin/env bash
# Inside the guest, on virtual time: six of the runs of guard_pairs.sh.
every=9
# shellcheck source=tests/guest/daemon_in_guest/guard_pairs.sh
. "$(dirname "$0")/guard_pairs.sh"
