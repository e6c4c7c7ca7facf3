#!/usr/bin/env bash
# Inside the guest: the DAQ driver against the kernel's simulated board and a parallel port.
# daq_test.cpp describes the tests.
# shellcheck source=tests/guest/check.sh
. "$(dirname "$0")/check.sh"

modprobe comedi comedi_num_legacy_minors=1  # a parallel port is not attached automatically
modprobe -a comedi_test comedi_parport
export DAQ_LINES=/dev/comedi0 DAQ_BOARD=/dev/comedi1
comedi_config $DAQ_LINES comedi_parport 0x378
comedi_config --read-buffer 64 $DAQ_BOARD
comedi_board_info $DAQ_BOARD | head -n 5

check "the driver's tests pass" chrt -f 70 /mnt/share/guest_daq_test

dmesg >dmesg.txt
check "the kernel's log has no warning" refused \
  grep -E 'WARNING:|BUG:|\bOops\b|Call Trace:' dmesg.txt
conclude
