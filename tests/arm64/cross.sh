#!/usr/bin/env bash
# In a root of tests/clean_root.sh: cross-compiles for 64-bit ARM, runs the tests labelled unit and
# loop under qemu-user, and replays logs of both processors (replays.py).
# usage: cross.sh FOLDER     with logs of the other processor; gets those of this one
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
folder=$(realpath "$1")

tools/install-deps arm64
cmake --preset arm64
cmake --build --preset arm64
ctest --preset arm64 -j "$(nproc)"

flexarm="qemu-aarch64 build/arm64/bin/flexarm"
python3 tests/arm64/replays.py record "$flexarm" arm64 "$folder"
python3 tests/arm64/replays.py replay "$flexarm" arm64 "$folder"
