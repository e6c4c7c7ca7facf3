#!/usr/bin/env bash
# docs/fault-matrix.md is what the program finds: a change of a cause, a time or a peak shows here.
# usage: fault_matrix_check.sh FLEXARM
set -euo pipefail
flexarm=$(realpath "$1")
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
found=$(mktemp --suffix=.md)
trap 'rm -f "$found"' EXIT
rm "$found"
"$flexarm" torture -c config/hil.toml --matrix -o "$found"
diff docs/fault-matrix.md "$found"
