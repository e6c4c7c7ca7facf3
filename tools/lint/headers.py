#!/usr/bin/env python3
"""Compiles public headers on their own: those that changed of late (changed_files.py), or all.
Exit 1 if one does not compile. CMake has a source and a ninja target for each public header.
"""

import argparse
import json
import os
import shlex
import subprocess
import sys
from pathlib import Path

from changed_files import changed_files

ROOT = Path(__file__).resolve().parents[2]
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
    parser.add_argument("--changed", action="store_true", help="only what changed of late")
    parser.add_argument("-j", "--jobs", type=int, default=os.cpu_count(), help="files at a time")
    parser.add_argument("--note", type=Path, help="write the last line here too")
    options = parser.parse_args()
    commands = (options.build / "compile_commands.json").read_text(encoding="utf-8")
    targets = header_targets(json.loads(commands))
    if not targets:
        sys.exit(f"headers: {options.build} knows of no public header")
    changed = changed_files() if options.changed else None
    chosen = targets if changed is None else [name for name in changed if name in targets]
    failed = chosen and subprocess.run(
        ["cmake", "--build", str(options.build), "-j", str(options.jobs), "--target",
         *(targets[name] for name in chosen), "--", "-k", "0"], check=False).returncode
    summary = f"{len(chosen)} of {len(targets)} public headers"
    print(summary)
    if options.note:
        options.note.write_text(summary + "\n", encoding="utf-8")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
