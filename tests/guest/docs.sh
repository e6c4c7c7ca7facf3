#!/usr/bin/env bash
# Inside the guest, on virtual time: the command blocks of the pages that have the tag `guest`, in a
# clone with the built programs and in a folder with the installed ones (tests/docs/run_blocks.py
# has written the pages). Each page runs in a folder of its own.
# shellcheck source=tests/guest/check.sh
. "$(dirname "$0")/check.sh"

docs=/mnt/share/docs
cp -a /mnt/share/machine/. /
programs=$PATH

make_clone() { cp -r $docs/clone "$1"; }
make_installed() { mkdir "$1" && ln -s /usr/local/share/flexarm/config "$1/config"; }

# What a page has set up and the next sets up again: the interface and the chip of the emulated rig.
take_down() {
  local chip=/sys/kernel/config/gpio-sim/rig
  ip link delete vcan0 2>/dev/null
  if [[ -e $chip/live ]]; then
    echo 0 >$chip/live
    rmdir $chip/bank $chip
  fi
}

pages=0
for place in clone installed; do
  for page in $docs/pages/$place/*; do
    pages=$((pages + 1))
    folder=$PWD/$place-$(basename "$page" .md)
    make_$place "$folder"
    PATH=$programs
    if [[ $place == clone ]]; then PATH=$folder/build/release/bin:$programs; fi
    cd "$folder" || exit
    # A session of its own, which the limit ends.
    check "$place: $(basename "$page")" setsid --wait timeout 1800 bash $docs/page.sh "$page" </dev/null
    cd - >/dev/null || exit
    take_down
  done
done
check "there were pages" at_least "$pages" 2
conclude
