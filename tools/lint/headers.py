#!/usr/bin/env python3
"""Compiles public headers on their own: those that changed recently (changed_files.py), or all.
Exit 1 if one does not compile. CMake has a source and a ninja target for each public header.
"""

import argparse
import json
import os
import shlex
import subprocess
import sys
import time
from pathlib import Path

from changed_files import changed_files

ROOT = Path(__file__).resolve().parents[2]
GROUP = 40  # headers that one call of ninja compiles
FOLDER = "_verify_interface_header_sets/"


def header_targets(entries):
    """The object that ninja makes of each public header, by the header's path from the root."""
    targets = {}
    for entry in entries:
        if FOLDER in entry["file"]:
            header = entry["file"].rpartition(FOLDER)[2].removesuffix(".cxx")
            words = shlex.split(entry["command"])
            targets[header] = words[words.index("-o") + 1]
    return targets


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", type=Path, default=ROOT / "build/release",
                        help="build folder, configured (default: build/release)")
    parser.add_argument("--changed", action="store_true", help="only what changed recently")
    parser.add_argument("--within", type=float, default=float("inf"), metavar="SECONDS",
                        help="begin no further group of headers after this time; name the rest")
    parser.add_argument("-j", "--jobs", type=int, default=os.cpu_count(), help="files at a time")
    parser.add_argument("--note", type=Path, help="write the last line here too")
    options = parser.parse_args()
    commands = (options.build / "compile_commands.json").read_text(encoding="utf-8")
    targets = header_targets(json.loads(commands))
    if not targets:
        sys.exit(f"headers: {options.build} has no public header")
    changed = changed_files() if options.changed else None
    chosen = targets if changed is None else [name for name in changed if name in targets]
    chosen, left, failed = list(chosen), [], False
    end = time.monotonic() + (options.within if changed is not None else float("inf"))
    for first in range(0, len(chosen), GROUP):
        group = chosen[first:first + GROUP]
        if time.monotonic() > end:
            left += group
            continue
        failed |= subprocess.run(
            ["cmake", "--build", str(options.build), "-j", str(options.jobs), "--target",
             *(targets[name] for name in group), "--", "-k", "0"], check=False).returncode != 0
    for name in left:
        print(f"left: {name}")
    summary = f"{len(chosen) - len(left)} of {len(targets)} public headers"
    if left:
        summary += f", {len(left)} left for headers-all"
    print(summary)
    if options.note:
        options.note.write_text(summary + "\n", encoding="utf-8")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
