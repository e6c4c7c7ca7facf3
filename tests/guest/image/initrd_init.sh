#!/bin/busybox sh
# shellcheck shell=dash
# The first process of the guest: loads the modules for mounting, mounts the file systems, and
# starts the init program of the root image, guest.init=PROGRAM of the kernel's command line.
b=/bin/busybox
$b mount -t proc proc /proc
$b mount -t sysfs sys /sys
$b mount -t devtmpfs dev /dev
while read -r module; do
  $b insmod "/modules/$module" || echo "insmod $module failed"
done </modules/order
tries=0
while [ ! -b /dev/vda ] && [ $tries -lt 100 ]; do
  $b usleep 20000
  tries=$((tries + 1))
done
p9=trans=virtio,version=9p2000.L,msize=262144
$b mount -t ext4 -o rw,noatime /dev/vda /root || exec $b poweroff -f
$b mount -t 9p -o $p9,ro,cache=loose share /root/mnt/share
$b mount -t 9p -o $p9 out /root/mnt/out
init=/usr/local/sbin/guest-run
for word in $($b cat /proc/cmdline); do
  case $word in guest.init=*) init=${word#guest.init=} ;; esac
done
for folder in dev proc sys; do $b mount --move /$folder /root/$folder; done
exec $b switch_root /root "$init"
