#!/usr/bin/env bash
# Inside the guest: the driver of the safety lines, through the installed libgpiod, against a
# simulated chip. gpio_test.cpp describes the tests.
# shellcheck source=tests/guest/check.sh
. "$(dirname "$0")/check.sh"

modprobe gpio-sim  # before the mount: configfs exists only after a module uses it
mountpoint -q /sys/kernel/config || mount -t configfs none /sys/kernel/config
gpiodetect --version | head -n 1

check "the driver's tests pass" chrt -f 90 /mnt/share/guest_gpio_test

dmesg >dmesg.txt
check "the kernel's log has no warning" refused \
  grep -E 'WARNING:|BUG:|\bOops\b|Call Trace:' dmesg.txt
conclude
