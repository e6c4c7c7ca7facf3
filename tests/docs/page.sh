#!/usr/bin/env bash
# Runs the blocks of one page, in one shell and one folder, as a reader types them.
# usage: page.sh PAGE < /dev/null
#
# PAGE is a page of which all lines but those of its blocks are empty (run_blocks.py writes it), so
# that the numbers of the lines are those of the page. Each block begins with `block LINE`. The
# first command that fails ends the page. What the page started in the background is stopped at its
# end: it must not have failed before. The caller limits its time. To descriptor 9, or to the output
# without one: `block LINE BYTES`, BYTES the size of the output where it is a file, and `failed LINE
# STATUS COMMAND`.
set -Eeo pipefail

{ : >&9; } 2>/dev/null || exec 9>&1

page=$1
told=no  # yes: the page came to its end, or what failed has been told

block() {  # block LINE
  echo "block $1 $(stat -L -c %s "/proc/$$/fd/1")" >&9
}

failed() {  # failed STATUS LINE COMMAND
  trap - ERR
  told=yes
  echo "failed $2 $1 ${3//$'\n'/ }" >&9
  exit 1
}

at_end() {
  local status=$? process processes ended
  # A signal may end a process of this script before it has put the trap away.
  if [[ $BASHPID != "$$" ]]; then exit "$status"; fi
  trap - ERR
  set +e
  if [[ $told == no ]]; then
    echo "failed 0 $status the block ended the shell" >&9
    status=1
  fi
  processes=$(jobs -p)
  for process in $processes; do
    if kill -TERM "$process" 2>/dev/null; then
      wait "$process"
      continue
    fi
    wait "$process"
    ended=$?
    # 127: it ended well, and the shell has forgotten it.
    if ((ended != 0 && ended != 127)); then
      echo "failed 0 $ended a command in the background had ended" >&9
      status=1
    fi
  done
  exit "$status"
}

trap at_end EXIT
# shellcheck disable=SC2154
trap 'failed $? "$LINENO" "$BASH_COMMAND"' ERR
# shellcheck source=/dev/null
source "$page"
told=yes
