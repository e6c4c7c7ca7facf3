#!/usr/bin/env bash
# Inside the guest, with two processors and without virtual time: the threads of the wired stack at
# once, with buses that fail. No race, no deadlock, no lost answer; nothing about time.
# shellcheck source=tests/guest/check.sh
. "$(dirname "$0")/check.sh"

# The test looks for its config where it was built.
source_folder=$(cat /mnt/share/source_folder)
mkdir -p "$source_folder"
ln -s /mnt/share/config "$source_folder/config"

check "there are two processors" equal "$(nproc)" 2
check "SCHED_FIFO is permitted" chrt -f 90 true
export FLEXARM_CAMPAIGN=12
check "every request is answered and every thread ends" /mnt/share/wired_threads_test
dmesg >dmesg.txt
check "the kernel's log has no warning" refused grep -E 'WARNING:|BUG:|\bOops\b|Call Trace:' dmesg.txt
conclude
