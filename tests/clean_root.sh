#!/usr/bin/env bash
# Runs a command in a clone of this project inside a bare Debian, as after a new installation:
# mmdebstrap makes it in a temporary folder and removes it at the end. The clone has the last commit
# and the differences of tracked files. Needs root, or unprivileged user namespaces. With --share,
# the folder DIR is copied to ../share before the command, and back after it.
#
# usage: clean_root.sh [--share DIR] RELEASE COMMAND
#   e.g. clean_root.sh trixie './tools/run-hil && ./tools/run-tests --lane release'
set -euo pipefail

share=
if [[ ${1:-} == --share && -d ${2:-} ]]; then
  share=$(realpath "$2")
  shift 2
fi
export CLEAN_ROOT_SHARE=$share
if (($# != 2)); then
  sed -n '/^# usage: /,/^set/s/^# //p' "${BASH_SOURCE[0]}" >&2
  exit 2
fi
release=$1
export CLEAN_ROOT_COMMAND=$2
CLEAN_ROOT_SOURCE=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
export CLEAN_ROOT_SOURCE

# mmdebstrap's shell runs each hook, with the new root as $1.
# shellcheck disable=SC2016
hooks=(
  --customize-hook='git clone --quiet --no-hardlinks "$CLEAN_ROOT_SOURCE" "$1/root/flexarm"'
  --customize-hook='git -C "$CLEAN_ROOT_SOURCE" diff --binary HEAD |'\
' git -C "$1/root/flexarm" apply --allow-empty --whitespace=nowarn'
)
# shellcheck disable=SC2016
if [[ -n $share ]]; then
  hooks+=(--customize-hook='cp -r "$CLEAN_ROOT_SHARE" "$1/root/share"')
fi
# shellcheck disable=SC2016
hooks+=(--customize-hook='chroot "$1" /usr/bin/env -i HOME=/root TERM=dumb'\
' PATH=/usr/sbin:/usr/bin:/sbin:/bin bash -c "cd /root/flexarm && $CLEAN_ROOT_COMMAND"')
# shellcheck disable=SC2016
if [[ -n $share ]]; then
  hooks+=(--customize-hook='cp -r "$1/root/share/." "$CLEAN_ROOT_SHARE"')
fi
mmdebstrap --quiet --variant=minbase --include=ca-certificates,git "${hooks[@]}" "$release" \
  /dev/null
