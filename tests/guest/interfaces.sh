#!/usr/bin/env bash
# Inside the guest: the kernel interfaces for the tests of drivers exist and work. Each block also
# shows how to set up its interface.
# shellcheck source=tests/guest/check.sh
. "$(dirname "$0")/check.sh"

echo "== real time"
check "the kernel is PREEMPT_RT" equal "$(cat /sys/kernel/realtime)" 1
check "SCHED_FIFO is permitted" chrt -f 90 true
check "memory can be locked" cyclictest -q -m -p 90 -i 1000 -l 50

echo "== SocketCAN"
modprobe -a vcan can-raw
ip link add vcan0 type vcan && ip link set vcan0 up
candump -n 1 vcan0 >can.txt &
listener=$!
sleep 0.5
cansend vcan0 123#DEADBEEF
wait $listener
check "a CAN frame arrives" grep -q '123 *\[4\]  DE AD BE EF' can.txt
ip link set vcan0 txqueuelen 10  # as the driver requires
check "the CAN driver's tests pass on it" /mnt/share/hal_canopen_socketcan_test >driver.txt
grep -vE '^\[ RUN|^$' driver.txt
check "none of them was skipped" refused grep -q SKIPPED driver.txt

echo "== comedi"
modprobe comedi_test  # is attached automatically
check "a DAQ board exists" ls /dev/comedi0

echo "== the kernel's log"
dmesg >dmesg.txt
check "was read" grep -q 'Linux version' dmesg.txt
check "has no warning" refused grep -E 'WARNING:|BUG:|\bOops\b|Call Trace:' dmesg.txt
conclude
